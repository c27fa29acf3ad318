// A convenience: a click on a heading sorts its table. Every page reads in full without it.
document.querySelectorAll("table.sortable").forEach(function (table) {
  var body = table.tBodies[0];
  if (body.rows.length < 2) return;
  table.querySelectorAll("th[data-sort]").forEach(function (heading, column) {
    var button = document.createElement("button");
    button.type = "button";
    while (heading.firstChild) button.appendChild(heading.firstChild);
    heading.appendChild(button);
    heading.setAttribute("aria-sort", "none");
    heading.addEventListener("click", function () {  // beside the button too: a heading is wider than its text
      var up = heading.getAttribute("aria-sort") !== "ascending";
      table.querySelectorAll("th[data-sort]").forEach(function (other) { other.setAttribute("aria-sort", "none"); });
      heading.setAttribute("aria-sort", up ? "ascending" : "descending");
      var value = function (row) {
        var cell = row.cells[column], text = cell.dataset.v || cell.textContent.replace(/\u202f/g, "").replace("\u2212", "-");
        return /^-?[\d.]+(e[-+]?\d+)?(?![\w\/])/.test(text) ? parseFloat(text) : text;
      };
      Array.from(body.rows).sort(function (a, b) {
        var x = value(a), y = value(b);
        var order = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y));
        return up ? order : -order;
      }).forEach(function (row) { body.appendChild(row); });
    });
  });
});
