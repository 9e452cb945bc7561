// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the mouse does on the picture.

const line = document.querySelector('#drag line');

function show_line(a, b) {
  line.style.visibility = a ? 'visible' : 'hidden';
  if (!a) return;
  [['x1', a[0]], ['y1', a[1]], ['x2', b[0]], ['y2', b[1]]].forEach(([key, value]) => line.setAttribute(key, value));
}

// `tool()`: the chosen one. `hands`: cut(a, b) with the ends of a drag of the knife; grab(point),
// drag(point) and let_go() of the hand.
export function follow_mouse(picture, tool, hands) {
  const canvas = picture.canvas;
  let drag = null;  // {button, tool, from, last, point}
  const place = (event) => [event.offsetX, event.offsetY];

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    const now = place(event);
    drag = { button: event.button, tool: event.button === 0 ? tool() : 'look', from: now, last: now };
    if (drag.tool !== 'grab') return;
    drag.point = picture.point_at(...now);
    if (drag.point) hands.grab(drag.point);
    else drag.tool = 'look';
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!drag) return;
    const now = place(event), right = now[0] - drag.last[0], down = now[1] - drag.last[1];
    drag.last = now;
    if (drag.tool === 'knife') show_line(drag.from, now);
    else if (drag.tool === 'grab') hands.drag(picture.led(drag.point, ...now));
    else if (drag.button === 0 && !event.shiftKey) picture.turn(right * 0.008, down * 0.008);
    else picture.move(right / canvas.clientHeight, down / canvas.clientHeight);
  });
  const end = (event) => {
    const done = drag;
    drag = null;
    show_line(null);
    if (done?.tool === 'grab') hands.let_go();
    if (done?.tool !== 'knife' || event.type !== 'pointerup') return;
    const now = place(event);
    if (Math.hypot(now[0] - done.from[0], now[1] - done.from[1]) > 3) hands.cut(done.from, now);
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    picture.zoom(Math.exp(event.deltaY * 0.001));
  }, { passive: false });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
}
