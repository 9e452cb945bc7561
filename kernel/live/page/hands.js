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
// take(tool, point), drag(point) and let_go() of the hand; pierce(point), and suture(a, b) with places
// at rest.
export function follow_mouse(picture, tool, hands) {
  const canvas = picture.canvas;
  let drag = null;  // {button, tool, from, last, point}
  const place = (event) => [event.offsetX, event.offsetY];

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    const now = place(event);
    drag = { button: event.button, tool: event.button === 0 ? tool() : 'look', from: now, last: now };
    begin[drag.tool]?.(now);
  });
  const begin = {
    grab(now) {
      const hit = picture.hit(...now);
      if (hit) hands.grab(drag.point = hit.point);
      else drag.tool = 'look';
    },
    push(now) {
      const hit = picture.tool_at(...now);
      if (hit) hands.take(hit.tool, drag.point = hit.point);
      else drag.tool = 'look';
    },
  };
  canvas.addEventListener('pointermove', (event) => {
    if (!drag) return;
    const now = place(event), right = now[0] - drag.last[0], down = now[1] - drag.last[1];
    drag.last = now;
    if (drag.tool === 'knife' || drag.tool === 'suture') show_line(drag.from, now);
    else if (drag.point) hands.drag(picture.led(drag.point, ...now));
    else if (drag.tool === 'needle') return;
    else if (drag.button === 0 && !event.shiftKey) picture.turn(right * 0.008, down * 0.008);
    else picture.move(right / canvas.clientHeight, down / canvas.clientHeight);
  });
  const end = (event) => {
    const done = drag;
    drag = null;
    show_line(null);
    if (done?.point) hands.let_go();
    if (done && event.type === 'pointerup') finish[done.tool]?.(done.from, place(event));
  };
  const finish = {
    knife(from, to) {
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) > 3) hands.cut(from, to);
    },
    needle(from) {
      const hit = picture.hit(...from);
      if (hit) hands.pierce(hit.point);
    },
    suture(from, to) {
      const ends = [picture.hit(...from), picture.hit(...to)].filter(Boolean);
      if (ends.length) hands.suture(ends[0].rest, ends.at(-1).rest);
    },
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    picture.zoom(Math.exp(event.deltaY * 0.001));
  }, { passive: false });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
}
