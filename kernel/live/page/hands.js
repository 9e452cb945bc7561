// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the mouse does on the picture.

const line = document.querySelector('#drag line');

function show_line(a, b) {
  line.style.visibility = a ? 'visible' : 'hidden';
  if (!a) return;
  [['x1', a[0]], ['y1', a[1]], ['x2', b[0]], ['y2', b[1]]].forEach(([key, value]) => line.setAttribute(key, value));
}

// `tool()`: the chosen one. `cut(a, b)` is called with the ends of a drag of the knife.
export function follow_mouse(picture, tool, cut) {
  const canvas = picture.canvas;
  let drag = null;  // {button, tool, from, last}
  const place = (event) => [event.offsetX, event.offsetY];

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    const is_knife = tool() === 'knife' && event.button === 0;
    drag = { button: event.button, tool: is_knife ? 'knife' : 'look', from: place(event), last: place(event) };
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!drag) return;
    const now = place(event), right = now[0] - drag.last[0], down = now[1] - drag.last[1];
    drag.last = now;
    if (drag.tool === 'knife') show_line(drag.from, now);
    else if (drag.button === 0 && !event.shiftKey) picture.turn(right * 0.008, down * 0.008);
    else picture.move(right / canvas.clientHeight, down / canvas.clientHeight);
  });
  canvas.addEventListener('pointerup', (event) => {
    const done = drag;
    drag = null;
    show_line(null);
    if (done && done.tool === 'knife' && Math.hypot(place(event)[0] - done.from[0], place(event)[1] - done.from[1]) > 3)
      cut(done.from, place(event));
  });
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    picture.zoom(Math.exp(event.deltaY * 0.001));
  }, { passive: false });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
}
