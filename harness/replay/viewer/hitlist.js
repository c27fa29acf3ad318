// The list of hits: as tall as all its rows, of which only the visible ones exist. A click on a row jumps to its hit.

const ROW = 30; // px

export class HitList {
  /** Into an element that scrolls; `jump` is called with a hit. */
  constructor(element, jump) {
    this.element = element;
    this.list = element.querySelector("ol");
    this.jump = jump;
    this.shown = [];
    element.addEventListener("scroll", () => this._render());
    new ResizeObserver(() => this._render()).observe(element);
    this.list.addEventListener("click", (event) => {
      const row = event.target.closest("button");
      if (row) this.jump(Number(row.dataset.hit));
    });
    this.list.addEventListener("keydown", (event) => {
      const by = { ArrowDown: 1, ArrowUp: -1 }[event.key], row = event.target.closest("li");
      if (!by || !row) return;
      event.preventDefault();
      const next = by > 0 ? row.nextElementSibling : row.previousElementSibling;
      if (next) next.firstElementChild.focus();
    });
  }

  /** Show these hits of a recording, by their numbers. */
  load(recording, hits) {
    this.recording = recording;
    this.shown = hits;
    this._first = this._last = -1;
    this._now = null;
    this.list.style.height = `${hits.length * ROW}px`;
    this._render();
  }

  /** Mark what happens at the time that is shown, and keep it in sight. */
  follow(time, window_) {
    const { recording, shown } = this;
    let place = 0, end = shown.length;
    while (place < end) {
      const middle = (place + end) >> 1;
      if (recording.hit_times[shown[middle]] <= time) place = middle + 1;
      else end = middle;
    }
    const now = `${place} ${place && time - recording.hit_times[shown[place - 1]] <= window_}`;
    if (now === this._now) return;
    this._now = now;
    this._place = place - 1;
    this._time = time;
    this._window = window_;
    if (!this.list.contains(document.activeElement)) {
      this.element.scrollTop = Math.max(0, (place - 1) * ROW - this.element.clientHeight / 3);
    }
    this._render(true);
  }

  _render(again = false) {
    const { element, list, recording, shown } = this;
    if (!recording) return;
    const first = Math.max(0, Math.floor(element.scrollTop / ROW) - 3);
    const last = Math.min(shown.length, Math.ceil((element.scrollTop + element.clientHeight) / ROW) + 3);
    if (!again && first === this._first && last === this._last) return;
    [this._first, this._last] = [first, last];
    const focused = list.contains(document.activeElement) ? document.activeElement.dataset.hit : null;
    list.replaceChildren(...shown.slice(first, last).map((hit, place) => this._row(hit, first + place)));
    if (focused !== null) list.querySelector(`[data-hit="${focused}"]`)?.focus({ preventScroll: true });
  }

  _row(hit, place) {
    const { recording } = this, row = document.createElement("li"), button = document.createElement("button");
    const wall = recording.hit_second[hit] < 0, time = recording.hit_times[hit];
    row.style.top = `${place * ROW}px`;
    row.setAttribute("aria-setsize", this.shown.length);
    row.setAttribute("aria-posinset", place + 1);
    button.type = "button";
    button.dataset.hit = hit;
    const fresh = place <= this._place && this._time - time <= this._window;
    button.className = `${wall ? "wall" : "pair"}${fresh ? " now" : ""}${place > (this._place ?? -1) ? " ahead" : ""}`;
    if (fresh) button.setAttribute("aria-current", "true");
    const when = document.createElement("span"), who = document.createElement("span");
    when.textContent = `${time.toFixed(3)} s`;
    who.textContent = recording.nameOf(hit);
    button.append(when, who);
    row.append(button);
    return row;
  }
}
