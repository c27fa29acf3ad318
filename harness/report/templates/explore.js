// The form above the table of all points: it filters, arranges and groups rows, and saves those that are left as CSV or
// Parquet. What is shown stands in the address, after the hash: #algorithm=grid&algorithm=sap&count=10..100&sort=-run_seconds
// &columns=count,run_seconds&group=algorithm. The page reads in full without it.
document.querySelectorAll("table.explored").forEach((table) => {
  const form = document.querySelector("form.explore"), body = table.tBodies[0], CHECKED_AT_MOST = 12, LEAVES_AT_FIRST = 6;
  const columns = Array.from(table.tHead.rows[0].cells, (cell, place) => ({
    cell, place, name: cell.dataset.name, title: cell.textContent, leaf: cell.dataset.kind === "leaf",
    numeric: cell.classList.contains("n"), unit: cell.dataset.unit || "", first: "first" in cell.dataset,
  }));
  const named = new Map(columns.map((column) => [column.name, column]));
  const plain = (text) => text.trim().replace(/\u202f/g, "").replace(/\u00a0/g, " ").replace(/\u2212/g, "-");
  const rows = Array.from(body.rows, (element) => {
    const texts = Array.from(element.cells, (cell) => plain(cell.textContent));
    const values = columns.map(({ numeric, place }) => {
      if (!texts[place]) return null;
      return numeric ? Number(element.cells[place].dataset.v || texts[place]) : texts[place];
    });
    return { element, texts, values };
  });
  const order = (a, b) => (a === null ? 1 : 0) - (b === null ? 1 : 0) || (typeof a === "number" ? a - b : String(a).localeCompare(String(b)));
  const choices = (column) => {
    const found = new Map(rows.map((row) => [row.texts[column.place], row.values[column.place]]));
    return Array.from(found).sort((a, b) => order(a[1], b[1])).map(([text]) => text);
  };
  const make = (name, attributes, ...children) => {
    const element = Object.assign(document.createElement(name), attributes);
    element.append(...children);
    return element;
  };

  // the state: which rows, which columns (null for those that tell rows apart), in which order, under which headings; and
  // what follows from it
  let state, kept = [], shown = [];
  const read = () => {
    const said = new URLSearchParams(location.hash.slice(1)), sort = said.get("sort") || "";
    state = { where: new Map(), columns: null, sort: sort.replace(/^-/, ""), down: sort.startsWith("-"), group: said.get("group") || "" };
    if (!named.has(state.sort)) state.sort = "";
    if (!named.has(state.group)) state.group = "";
    if (said.has("columns")) state.columns = new Set(said.get("columns").split(",").filter((name) => named.has(name)));
    for (const name of new Set(said.keys())) if (named.has(name)) state.where.set(name, said.getAll(name));
  };
  const write = () => {
    const said = new URLSearchParams();
    state.where.forEach((values, name) => values.forEach((value) => said.append(name, value)));
    if (state.columns) said.set("columns", Array.from(state.columns).join(","));
    if (state.sort) said.set("sort", (state.down ? "-" : "") + state.sort);
    if (state.group) said.set("group", state.group);
    history.replaceState(null, "", "#" + said);
  };

  const fits = (row) => Array.from(state.where).every(([name, wanted]) => {
    const { place } = named.get(name), value = row.values[place];
    return wanted.some((one) => {
      const range = /^(.*)\.\.(.*)$/.exec(one);
      if (!range || typeof value !== "number") return row.texts[place] === one;
      return (range[1] === "" || value >= Number(range[1])) && (range[2] === "" || value <= Number(range[2]));
    });
  });
  const differ = ({ place }) => kept.some((row) => row.texts[place] !== kept[0].texts[place]);
  const shownColumns = () => {
    if (state.columns) return columns.filter(({ name, place }) => place === 0 || state.columns.has(name));
    const leaves = columns.filter((column) => column.leaf && column.first && column.place > 2 && differ(column)).slice(0, LEAVES_AT_FIRST);
    return columns.filter((column) => column.place < 2 || leaves.includes(column) || (column.first && differ(column) && (column.place === 2 || !column.leaf)));
  };
  const measure = (value, unit) => {
    const steps = { s: [[1, "s"], [1e-3, "ms"], [1e-6, "\u00b5s"], [1e-9, "ns"]], B: [[1e9, "GB"], [1e6, "MB"], [1e3, "kB"], [1, "B"]] }[unit] || [[1, unit]];
    const [factor, symbol] = steps.find(([size]) => Math.abs(value) >= size) || steps[steps.length - 1];
    const digits = unit && value ? { minimumSignificantDigits: 3, maximumSignificantDigits: 3 } : { maximumSignificantDigits: 3 };
    return (value / factor).toLocaleString("en", digits).replace(/,/g, "\u202f").replace("-", "\u2212") + (symbol ? "\u00a0" + symbol : "");
  };
  const median = (values) => {
    const sorted = values.filter((value) => value !== null).sort((a, b) => a - b), middle = sorted.length >> 1;
    return sorted.length ? (sorted[middle] + sorted[sorted.length - 1 - middle]) / 2 : null;
  };
  const heading = (text, members) => {
    const line = make("tr", { className: "group" }, make("th", { scope: "row", textContent: `${text || "none"}: ${members.length}` }));
    columns.slice(1).forEach(({ leaf, place, unit }) => {
      const middle = leaf ? null : median(members.map((row) => row.values[place]));
      line.append(make("td", { className: "n", textContent: middle === null ? "" : measure(middle, unit) }));
    });
    return line;
  };

  const hiding = document.head.appendChild(document.createElement("style"));
  const show = () => {
    kept = rows.filter(fits);
    const by = (name) => (a, b) => order(a.values[named.get(name).place], b.values[named.get(name).place]);
    if (state.sort) kept.sort((a, b) => {
      const [x, y] = [a, b].map((row) => row.values[named.get(state.sort).place]);
      return state.down && x !== null && y !== null ? order(y, x) : order(x, y);
    });
    if (state.group) kept.sort(by(state.group));
    shown = kept.length ? shownColumns() : columns.filter((column) => column.place < 2);
    hiding.textContent = columns.filter((column) => !shown.includes(column)).map(({ place }) => `.explored tr > :nth-child(${place + 1})`).join(",") + " { display: none; }";
    const lines = [];
    if (state.group) {
      const { place } = named.get(state.group), groups = new Map();
      kept.forEach((row) => groups.set(row.texts[place], [...(groups.get(row.texts[place]) || []), row]));
      groups.forEach((members, text) => lines.push(heading(text, members), ...members.map((row) => row.element)));
    } else lines.push(...kept.map((row) => row.element));
    body.replaceChildren(...lines);
    columns.forEach(({ cell, name }) => cell.setAttribute("aria-sort", name !== state.sort ? "none" : state.down ? "descending" : "ascending"));
    const medians = state.group ? "; beside a group stand the medians of its points" : "";
    form.elements.count.textContent = `${kept.length} of ${rows.length} points${medians}`;
    form.elements.group.value = state.group;
    fill();
  };
  const change = () => { show(); write(); };

  // the controls: a list to tick a leaf with few values, two limits one with many, a list of columns
  const box = (text, value) => make("label", {}, make("input", { type: "checkbox", value }), " " + text);
  const limit = (word) => make("label", {}, word + " ", make("input", { type: "number", step: "any" }));
  const controls = new Map();
  columns.filter((column) => column.leaf).forEach((column) => {
    const values = choices(column), ranged = column.numeric && values.length > CHECKED_AT_MOST;
    if (values.length < 2) return;
    const inputs = ranged ? [limit("from"), limit("to")] : values.map((value) => box(value || "none", value));
    const details = make("details", {}, make("summary", {}), make("div", { className: "choices" }, ...inputs));
    const read = () => Array.from(details.querySelectorAll("input"));
    controls.set(column.name, { details, ranged, read });
    details.addEventListener("change", () => {
      const [low, high] = read().map((input) => input.value);
      const wanted = ranged ? (low + high ? [`${low}..${high}`] : []) : read().filter((input) => input.checked).map((input) => input.value);
      if (wanted.length) state.where.set(column.name, wanted); else state.where.delete(column.name);
      change();
    });
    form.querySelector(".filters").append(details);
    form.elements.group.append(make("option", { value: column.name, textContent: column.title }));
  });
  const picked = make("details", {}, make("summary", {}), make("div", { className: "choices" }, ...columns.slice(1).map(({ title, name }) => box(title, name))));
  picked.addEventListener("change", () => {
    state.columns = new Set(Array.from(picked.querySelectorAll("input:checked"), (input) => input.value));
    change();
  });
  form.querySelector(".filters").append(picked);
  const fill = () => {
    controls.forEach(({ details, ranged, read }, name) => {
      const wanted = state.where.get(name) || [], [low, high] = ((ranged && wanted[0]) || "..").split("..");
      details.querySelector("summary").textContent = named.get(name).title + (wanted.length ? ": " + wanted.map((one) => one || "none").join(", ") : "");
      details.classList.toggle("chosen", wanted.length > 0);
      details.hidden = !wanted.length && !details.open && !differ(named.get(name));  // nothing to filter by
      if (ranged) read().forEach((input, place) => { input.value = [low, high][place] || ""; });
      else read().forEach((input) => { input.checked = wanted.includes(input.value); });
    });
    picked.querySelector("summary").textContent = `Columns: ${shown.length} of ${columns.length}`;
    picked.querySelectorAll("input").forEach((input) => { input.checked = shown.includes(named.get(input.value)); });
  };
  columns.forEach((column) => {
    const button = make("button", { type: "button" }, ...column.cell.childNodes);
    column.cell.append(button);
    column.cell.addEventListener("click", () => {  // beside the button too: a heading is wider than its text
      state.down = state.sort === column.name && !state.down;
      state.sort = column.name;
      change();
    });
  });
  form.elements.group.addEventListener("change", () => { state.group = form.elements.group.value; change(); });
  form.elements.reset.addEventListener("click", () => { location.hash = ""; read(); change(); });
  form.addEventListener("submit", (event) => event.preventDefault());

  const save = (name, kind, contents) => {
    const link = make("a", { download: name, href: URL.createObjectURL(new Blob([contents], { type: kind })) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  form.elements.csv.addEventListener("click", () => {
    const quoted = (text) => (/[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
    const lines = kept.map((row) => shown.map(({ place }) => quoted(row.values[place] === null ? "" : String(row.values[place]))));
    save("points.csv", "text/csv", [shown.map((column) => column.name), ...lines].map((line) => line.join(",") + "\n").join(""));
  });
  form.elements.parquet.addEventListener("click", () => {
    const data = shown.map(({ name, numeric, place }) => ({ name, numeric, values: kept.map((row) => row.values[place]) }));
    save("points.parquet", "application/vnd.apache.parquet", parquet(data, kept.length));
  });
  window.addEventListener("hashchange", () => { read(); show(); });
  form.hidden = false;
  read();
  show();
});
