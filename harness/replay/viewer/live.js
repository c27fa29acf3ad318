// The live page: each change of a setting is run at once and shown, and its costs are added on top of the table.

import { Recording } from "./recording.js";

const KEPT = 8;

export function startLivePage(replay) {
  const form = document.getElementById("settings"), outcome = document.getElementById("outcome");
  const rows = document.getElementById("costs").tBodies[0];
  let running = false, again = false, waiting = 0;
  const run = async () => {
    if (running) {
      again = true; // the newest settings are run when this run has ended
      return;
    }
    running = true;
    form.setAttribute("aria-busy", "true");
    outcome.className = "busy";
    outcome.textContent = "Running …";
    try {
      const answer = await fetch(`run?${new URLSearchParams(new FormData(form))}`);
      const result = await answer.json();
      outcome.className = result.error ? "wrong" : "";
      outcome.textContent = result.error || result.said;
      if (!result.error) show(result);
    } catch (error) {
      outcome.className = "wrong";
      outcome.textContent = "The server does not answer any more. Start it again with `harness view --live`.";
    }
    running = false;
    form.removeAttribute("aria-busy");
    if (again) {
      again = false;
      run();
    }
  };
  const show = (result) => {
    const row = document.createElement("tr");
    for (const [place, text] of result.row.entries()) {
      const cell = document.createElement(place ? "td" : "th");
      if (!place) cell.scope = "row";
      cell.textContent = text;
      row.append(cell);
    }
    rows.prepend(row);
    while (rows.rows.length > KEPT) rows.lastElementChild.remove();
    document.getElementById("cost-table").hidden = false;
    if (result.recording) {
      replay.show(new Recording(result.recording));
      replay.begin();
    }
  };
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    clearTimeout(waiting);
    run();
  });
  form.addEventListener("change", () => {
    clearTimeout(waiting);
    waiting = setTimeout(run, 150); // a press of Enter is a change and a submission
  });
  run();
}
