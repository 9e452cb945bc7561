// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the mouse does on the picture.

const line = document.querySelector('#drag polyline');

const show_line = (way) => line.setAttribute('points', way.map((place) => place.join()).join(' '));
const length = ([ax, ay], [bx, by]) => Math.hypot(bx - ax, by - ay);
const spacing = 8;  // of the places of a way, pixels

// `tool()`: the chosen one. `hands`: cut(way) with the places of a drag of the knife on the canvas; grab(point),
// take(tool, point), drag(point) and let_go() of the hand; pierce(point), and suture(a, b) with places
// at rest; aim() when the mouse goes down for knife, needle or suture. Returns a function that ends a drag without effect.
export function follow_mouse(picture, tool, hands) {
  const canvas = picture.canvas;
  let drag = null;  // {button, tool, way, last, point}
  const place = (event) => [event.offsetX, event.offsetY];

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    const now = place(event);
    drag = { button: event.button, tool: event.button === 0 ? tool() : 'look', way: [now], last: now };
    begin[drag.tool]?.(now);
  });
  const begin = {
    knife: hands.aim,
    needle: hands.aim,
    suture: hands.aim,
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
    if (length(drag.way.at(-1), now) > spacing) drag.way.push(now);
    if (drag.tool === 'knife') show_line(hands.is_path() ? drag.way : [drag.way[0], now]);
    else if (drag.tool === 'suture') show_line([drag.way[0], now]);
    else if (drag.point) hands.drag(picture.led(drag.point, ...now));
    else if (drag.tool === 'needle') return;
    else if (drag.button === 0 && !event.shiftKey) picture.turn(right * 0.008, down * 0.008);
    else picture.move(right / canvas.clientHeight, down / canvas.clientHeight);
  });
  // It ends at a place of its own, or where it began.
  const way_to = (place, way) => (length(way.at(-1), place) > 1 || way.length === 1 ? [...way, place] : way);
  const cancel = () => {
    const done = drag;
    drag = null;
    show_line([]);
    if (done?.point) hands.let_go();
    return done;
  };
  const end = (event) => {
    const done = cancel();
    if (done && event.type === 'pointerup') finish[done.tool]?.(way_to(place(event), done.way));
  };
  const finish = {
    knife(way) {
      if (way.length > 2 || length(...way) > 3) hands.cut(way);
    },
    needle(way) {
      const hit = picture.hit(...way[0]);
      if (hit) hands.pierce(hit.point);
    },
    suture(way) {
      const ends = [picture.hit(...way[0]), picture.hit(...way.at(-1))].filter(Boolean);
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
  return cancel;
}
