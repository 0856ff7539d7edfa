"use strict";
(() => {
  const steps = JSON.parse(document.getElementById("sweep-data").textContent);
  const slider = document.getElementById("sweep-slider");
  const curve = document.getElementById("sweep-curve");
  const bandwidth = document.getElementById("sweep-bandwidth");
  const note = document.getElementById("sweep-note");
  const pointer = document.getElementById("sweep-pointer");
  const dots = pointer ? pointer.querySelectorAll("circle") : [];
  const cells = document.querySelectorAll("#sweep [data-cell]");
  const buttons = document.querySelectorAll("#sweep [data-step]");

  const show = () => {
    const step = steps[slider.valueAsNumber];
    curve.setAttribute("d", step.curve);
    bandwidth.textContent = step.bandwidth;
    slider.setAttribute("aria-valuetext", step.bandwidth);
    note.textContent = step.note;
    for (const cell of cells) cell.textContent = step.cells[cell.dataset.cell];
    if (!pointer) return;
    pointer.setAttribute("transform", `translate(${step.at} 0)`);
    dots.forEach((dot, index) => {
      const height = step.dots[index];
      dot.setAttribute("visibility", height === null ? "hidden" : "visible");
      if (height !== null) dot.setAttribute("cy", height);
    });
  };

  slider.addEventListener("input", show);
  for (const button of buttons) {
    button.addEventListener("click", () => {
      slider.value = button.dataset.step;
      show();
    });
    button.disabled = false;
  }
  slider.disabled = false;
  show();
})();
