// The form beside the map: it looks up the nearest measured cell in the table below it, and copies what stands there.
document.querySelectorAll("form.finder").forEach(function (form) {
  var rows = Array.from(document.querySelectorAll("#cells tbody tr")), answer = form.querySelector(".answer");
  var far = function (asked, measured) {
    return asked > 0 && measured > 0 ? Math.abs(Math.log(asked / measured)) : Math.abs(asked - measured);
  };
  var line = function (name, text) {
    var made = document.createElement(name);
    made.textContent = text;
    answer.appendChild(made);
    return made;
  };
  var find = function () {
    var x = form.elements.x.valueAsNumber, y = form.elements.y.valueAsNumber, best = null, least = Infinity;
    answer.textContent = "";
    if (!isFinite(x) || !isFinite(y)) { line("p", "Give two numbers."); return; }
    rows.forEach(function (row) {
      var data = row.dataset;
      if (data.shape !== form.elements.shape.value || data.query !== form.elements.query.value) return;
      if (data.accuracy !== form.elements.accuracy.value) return;
      var distance = far(x, +data.x) + far(y, +data.y);
      if (distance < least) { least = distance; best = row; }
    });
    if (!best) { line("p", "Nothing of this kind was measured."); return; }
    var text = function (column) { return best.cells[column].textContent; };
    line("p", text(0)).className = "method";
    line("p", [text(4), text(5), text(6)].filter(Boolean).join("; ") + ".");
    line("pre", text(7)).tabIndex = 0;  // it scrolls where the page is narrow
    var exact = +best.dataset.x === x && +best.dataset.y === y;
    line("p", (exact ? "Measured there: " : "Nearest measured point, nothing in between is guessed: ") + text(1) + ", " + text(2) + ".").className = "note";
  };
  form.hidden = false;
  form.addEventListener("input", find);
  form.addEventListener("submit", function (event) { event.preventDefault(); });
  find();
});
