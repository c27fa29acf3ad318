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
    var [method, atX, atY, , cost, next, sure, yaml] = Array.from(best.cells, function (cell) { return cell.textContent; });
    line("p", method).className = "method";
    line("p", [cost, next, sure].filter(Boolean).join("; ") + ".");
    line("pre", yaml).tabIndex = 0;  // it scrolls where the page is narrow
    var exact = +best.dataset.x === x && +best.dataset.y === y;
    line("p", (exact ? "Measured there: " : "Nearest measured point, nothing in between is guessed: ") + atX + ", " + atY + ".").className = "note";
  };
  form.hidden = false;
  form.addEventListener("input", find);
  form.addEventListener("submit", function (event) { event.preventDefault(); });
  find();
});
