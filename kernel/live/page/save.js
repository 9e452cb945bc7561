// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures and videos of a canvas, as files of the browser.

function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export const save_picture = (canvas, name) => canvas.toBlob((blob) => save(blob, `${name}.png`));

export const save_text = (text, name) => save(new Blob([text], { type: 'application/json' }), name);

// A video from now until stop(); `failed(text)` says why there is none.
export class Video {
  constructor(canvas, name, failed) {
    const parts = [];
    try {
      this.recorder = new MediaRecorder(canvas.captureStream(30));
    } catch (error) {
      failed(`this browser cannot record a video: ${error.message}`);
      return;
    }
    this.recorder.ondataavailable = (event) => parts.push(event.data);
    this.recorder.onstop = () => save(new Blob(parts, { type: this.recorder.mimeType }), `${name}.webm`);
    this.recorder.start();
  }

  stop() {
    this.recorder?.stop();
  }
}
