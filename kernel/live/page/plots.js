// SPDX-License-Identifier: GPL-3.0-or-later
//
// Curves that grow while the run goes on.

const colours = ['#c0392b', '#27752e', '#2c5aa0', '#8e44ad', '#b9770e', '#117a8b'];
const most_points = 2000;  // of a plot; then every second one goes

const digits = (value) => (value === 0 ? '0' : Number(value).toPrecision(3));

class Plot {
  constructor(given, box) {
    this.given = given;
    this.times = [];
    this.curves = given.curves.map(() => []);
    const title = document.createElement('div'), unit = given.unit === '1' ? '' : `, ${given.unit}`;
    title.append(given.name + unit);
    given.curves.forEach((name, i) => {
      const label = document.createElement('span');
      label.style.color = colours[i % colours.length];
      label.textContent = ' ' + name;
      title.append(label);
    });
    this.canvas = document.createElement('canvas');
    box.append(title, this.canvas);
  }

  // A run that went back has other values from there on.
  add(time, values) {
    while (this.times.length && this.times.at(-1) >= time) {
      this.times.pop();
      for (const curve of this.curves) curve.pop();
    }
    this.times.push(time);
    this.curves.forEach((curve, i) => curve.push(values[i]));
    if (this.times.length <= most_points) return;
    const every_second = (_, i) => i % 2 === 0;
    this.times = this.times.filter(every_second);
    this.curves = this.curves.map((curve) => curve.filter(every_second));
  }

  draw() {
    const scale = window.devicePixelRatio, canvas = this.canvas, pen = canvas.getContext('2d');
    const width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * scale;
    canvas.height = height * scale;
    pen.scale(scale, scale);
    const values = this.curves.flat().filter(Number.isFinite);
    const low = Math.min(0, ...values), high = Math.max(0, ...values), first = this.times[0];
    const span = this.times.at(-1) - first || 1, range = high - low || 1;
    const x = (time) => 2 + (width - 4) * (time - first) / span, y = (value) => height - 2 - (height - 4) * (value - low) / range;
    pen.strokeStyle = '#bbb';
    pen.strokeRect(0.5, y(0), width - 1, 0);
    this.curves.forEach((curve, i) => {
      pen.strokeStyle = colours[i % colours.length];
      pen.lineWidth = 1.3;
      pen.beginPath();
      let is_down = false;  // a value that does not exist interrupts the curve
      curve.forEach((value, k) => {
        if (Number.isFinite(value)) is_down ? pen.lineTo(x(this.times[k]), y(value)) : pen.moveTo(x(this.times[k]), y(value));
        is_down = Number.isFinite(value);
      });
      pen.stroke();
    });
    pen.fillStyle = '#666';
    pen.font = '10px system-ui, sans-serif';
    pen.fillText(digits(high), 3, 10);
    if (low < 0) pen.fillText(digits(low), 3, height - 3);
    const end = `${digits(this.times.at(-1))} s`;
    pen.fillText(end, width - pen.measureText(end).width - 3, height - 3);
  }
}

export class Plots {
  // `box`: the element that shows them.
  constructor(box) {
    this.box = box;
    this.plots = [];
  }

  // The plots of a greeting; those that are there already keep their curves.
  set_up(given) {
    if (JSON.stringify(given) === JSON.stringify(this.plots.map((plot) => plot.given))) return;
    this.box.replaceChildren();
    this.plots = given.map((one) => {
      const box = document.createElement('div');
      this.box.append(box);
      return new Plot(one, box);
    });
  }

  // One number for each curve, in order.
  add(time, values) {
    let at = 0;
    for (const plot of this.plots) {
      plot.add(time, values.slice(at, at + plot.curves.length));
      at += plot.curves.length;
    }
    this.draw();
  }

  draw() {
    if (this.box.offsetParent === null) return;
    for (const plot of this.plots) if (plot.times.length) plot.draw();
  }
}
