// SPDX-License-Identifier: GPL-3.0-or-later
//
// Messages from and to the run, and everything on the page beside the picture.
import { colour_at } from './look.js';
import { Picture } from './scene.js';
import { follow_mouse } from './hands.js';
import { follow_keys } from './keys.js';
import { show_values } from './panel.js';
import { Plots } from './plots.js';
import { Video, save_picture, save_text } from './save.js';

const $ = (selector) => document.querySelector(selector);
const picture = new Picture($('#picture'));
const plots = new Plots($('#plots'));
const socket = new WebSocket(new URL('socket', location.href).href.replace(/^http/, 'ws'));
socket.binaryType = 'arraybuffer';

// What tests and the console can read.
const live = window.live = { picture, state: null, greeting: null, control: false, messages: [], drawn: 0,
  surface: null, kept: [] };

let is_awaited = false;  // by the run: that the last state is drawn

const send = (input) => socket.send(JSON.stringify(input));

// ---- from the run ----

function decode(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const take = (Type, count) => {
    const array = new Type(buffer, at, count);
    at += array.byteLength;
    return array;
  };
  return { head, take };
}

function take_message(buffer) {
  const { head, take } = decode(buffer);
  if (head.kind === 'surface') {
    picture.set_surface(head, take(Uint32Array, head.faces * head.corners), take(Float32Array, 3 * head.points));
    live.surface = head;
    return;
  }
  live.state = head;
  is_awaited = true;
  const points = live.surface.points;
  picture.set_state(head, take(Float32Array, 3 * points), take(Float32Array, points));
  show_numbers(head);
  if (head.plots) plots.add(head.time, head.plots);
}

// The next picture may come while this one is drawn.
picture.before_drawing = () => {
  show_force(live.state?.hand, $('#force'));
  show_force(live.state?.device, $('#device-force'));
  if (!is_awaited) return;
  is_awaited = false;
  ++live.drawn;
  if (socket.readyState === WebSocket.OPEN) socket.send(new Uint8Array(0));
};

function enable_inputs() {
  for (const input of document.querySelectorAll('[data-control], .tools input')) input.disabled = !live.control;
}

function take_text(message) {
  if (message.scene && live.control) save_text(message.scene, `${message.name}-done.json`);
  if (message.kept) show_kept(message.kept);
  if (message.values) {
    live.values = message.values;
    show_values($('#values'), message.values, apply);
    enable_inputs();
  }
  if (message.live) {
    live.greeting = message;
    document.title = message.title + ' - Suture';
    $('#field').replaceChildren(...message.fields.map((field) => new Option(field.name)));
    picture.set_up(message);
    plots.set_up(message.plots);
  } else if ('control' in message) {
    live.control = message.control;
    enable_inputs();
    if (!message.control) show_message('message', 'another page controls this run; this one watches');
  } else {
    for (const kind of ['message', 'warning', 'error']) if (kind in message) show_message(kind, message[kind]);
  }
}

socket.onmessage = (event) =>
  typeof event.data === 'string' ? take_text(JSON.parse(event.data)) : take_message(event.data);
socket.onclose = () => {
  show_message('error', 'the run has ended, or the connection was lost');
  live.control = false;
};

// ---- on the page ----

const digits = (value, count = 4) => Number(value).toPrecision(count);

function show_numbers(head) {
  $('#play').textContent = head.playing ? 'Pause' : 'Play';
  $('#speed').value = String(head.speed);
  $('#field').value = head.field;
  $('#numbers').textContent = [
    `${live.greeting.title}, ${live.greeting.elements} elements`,
    `t = ${digits(head.time)} s, step ${head.step}${head.ended ? ', ended' : ''}`,
    head.playing ? `${Number(digits(head.steps_per_second, 3))} steps/s, ${digits(head.real_time, 3)} of real time` : 'paused',
    `balance ${digits(100 * head.balance, 2)} %`].join('\n');
  $('#remedy').hidden = !head.remedy;
  $('#remedy').textContent = head.remedy ? head.remedy[0].toUpperCase() + head.remedy.slice(1) : '';
  $('#legend').hidden = head.field === 'island';
  const unit = live.greeting.fields.find((field) => field.name === head.field)?.unit;
  $('#legend-top').textContent = `${head.field}${unit && unit !== '1' ? ', ' + unit : ''}\n${digits(picture.range[1], 3)}`;
  $('#legend-bottom').textContent = digits(picture.range[0], 3);
}

// The force on what is held, beside it.
function show_force(held, text) {
  text.style.visibility = held ? 'visible' : 'hidden';
  if (!held) return;
  const [x, y] = picture.on_canvas(from_scene(held.place));
  text.textContent = `${digits(Math.hypot(...held.force), 3)} N`;
  text.style.left = `${x + 14}px`;
  text.style.top = `${y - 8}px`;
}

// A page that changes is drawn for longer than the picture that a hand waits for.
const later = (change) => setTimeout(change, 100);

function show_kept(kept) {
  live.kept = kept;
  const names = kept.map((state) => new Option(
    `${state.action ? 'before ' : ''}${state.name}, ${digits(state.time, 3)} s`, state.id));
  later(() => $('#kept').replaceChildren(new Option('go back to ...', ''), ...names.reverse()));
}

function show_message(kind, text) {
  live.messages.push({ kind, text });
  const item = document.createElement('li');
  item.className = kind;
  item.textContent = text;
  later(() => {
    $('#messages').append(item);
    if ($('#messages').children.length > 50) $('#messages').firstChild.remove();
    $('#messages').scrollTop = $('#messages').scrollHeight;
  });
}

function draw_legend() {
  const canvas = $('#legend canvas'), pen = canvas.getContext('2d');
  for (let y = 0; y < canvas.height; ++y) {
    pen.fillStyle = `rgb(${colour_at(1 - y / (canvas.height - 1)).join()})`;
    pen.fillRect(0, y, canvas.width, 1);
  }
}

const toggle = () => send({ do: live.state?.playing ? 'pause' : 'play' });
const clip = () => picture.clip($('#clip').value, Number($('#clip-at').value));

// In coordinates of the scene.
const in_scene = (point) => point.toArray().map((x, axis) => x + live.greeting.origin[axis]);
const from_scene = (place) => place.map((x, axis) => x - live.greeting.origin[axis]);
const apply = (event, aimed = false) => { if (live.control) send({ do: 'apply', event, aimed }); };

// A mouse moves more often than a hand needs to know; where it stops counts.
const drag_interval = 30;  // ms
let dragged = 0, drag_timer = 0;

function send_drag(point) {
  clearTimeout(drag_timer);
  const rest = dragged + drag_interval - performance.now();
  if (rest > 0) {
    drag_timer = setTimeout(send_drag, rest, point);
    return;
  }
  dragged = performance.now();
  send({ do: 'drag', to: in_scene(point) });
}

const hands = {
  aim() {
    if (live.control) send({ do: 'aim' });
  },
  is_path: () => $('#cut').value === 'path',
  cut(way) {
    const along = $('#along-blade').checked ? 'blade' : 'faces';
    if (!hands.is_path()) {
      const polygon = picture.plane_through(way[0], way.at(-1)).map(in_scene);
      return apply({ cut: { plane: { polygon }, along } }, true);
    }
    const { points, triangles } = picture.swept(way);
    apply({ sweep: { points: points.map(in_scene), triangles, along } }, true);
  },
  pierce(point) {
    apply({ pierce: { where: { nearest: in_scene(point) } } }, true);
  },
  // Around two places of the rest shape: lips that fit lie at the same place there.
  suture(a, b) {
    const centre = a.clone().add(b).divideScalar(2), radius = a.distanceTo(b) / 2 + 2 * live.greeting.edge;
    apply({ suture: { where: { sphere: { centre: in_scene(centre), radius } } } }, true);
  },
  take(tool, point) {
    if (live.control) send({ do: 'take', tool: live.greeting.obstacles[tool].name, at: in_scene(point) });
  },
  grab(point) {
    if (live.control) send({ do: 'grab', at: in_scene(point) });
  },
  drag(point) {
    if (live.control) send_drag(point);
  },
  let_go() {
    clearTimeout(drag_timer);
    if (live.control) send({ do: 'let_go' });
  },
};

const file_name = () => `${live.greeting.title.replace(/[^\w-]+/g, '-')}-${live.state.step}`;
let video = null;

function toggle_video() {
  video ? video.stop() : null;
  video = video ? null : new Video(picture.canvas, file_name(), (text) => show_message('error', text));
  $('#save-video').textContent = video ? 'End video' : 'Video';
}

draw_legend();
show_kept([]);
$('#play').onclick = toggle;
$('#remedy').onclick = () => send({ do: 'remove_piece' });
$('#step').onclick = () => send({ do: 'step' });
$('#reset').onclick = () => send({ do: 'reset' });
$('#back').onclick = () => send({ do: 'back' });
$('#keep').onclick = () => send({ do: 'keep' });
$('#kept').onchange = (event) => send({ do: 'back', to: Number(event.target.value) });
$('#checkpoint').onclick = () => send({ do: 'checkpoint' });
$('#scene').onclick = () => send({ do: 'scene' });
$('#save-picture').onclick = () => save_picture(picture.canvas, file_name());
$('#save-video').onclick = toggle_video;
$('#speed').onchange = (event) => send({ do: 'speed', value: Number(event.target.value) });
$('#field').onchange = (event) => send({ do: 'field', name: event.target.value });
$('#ghost').onchange = (event) => { picture.ghost.visible = event.target.checked; picture.draw(); };
$('#show-side').onchange = (event) => { $('#side').classList.toggle('open', event.target.checked); plots.draw(); };
$('#edges').onchange = (event) => { picture.shows_edges = event.target.checked; picture.draw(); };
$('#clip').onchange = clip;
$('#clip-at').oninput = clip;
$('#fit').onclick = () => picture.fit();
$('#show-help').onclick = () => $('#help').showModal();

const cancel = follow_mouse(picture, () => $('.tools input:checked').value, hands);
const press = (selector) => () => $(selector).click();
follow_keys([
  { key: 'space', does: 'plays or pauses', act: press('#play') },
  { key: '.', does: 'makes a step', act: press('#step') },
  { key: 'z', does: 'takes the last action back', act: press('#back') },
  { key: 'escape', does: 'lets go; ends a drag without a cut', act: cancel },
  { key: 'f', does: 'shows the whole body', act: press('#fit') },
  { key: 'e', does: 'shows or hides edges', act: press('#edges') },
  ...[...document.querySelectorAll('.tools input')].map((input) => (
    { key: input.value[0], does: `${input.value}: ${input.parentNode.title}`, act: () => input.click() })),
  { key: '?', does: 'shows this', act: press('#show-help') },
], $('#keys'));
