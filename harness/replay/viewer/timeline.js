// The number of hits over time, as bars above the slider, and a mark at the time that is shown.

export class Timeline {
  constructor(canvas) {
    this.canvas = canvas;
  }

  load(recording) {
    this.recording = recording;
    this._bars = null;
  }

  draw(time, colours) {
    const { canvas, recording } = this, scale = window.devicePixelRatio || 1;
    const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
    if (canvas.width !== width || canvas.height !== height || !this._bars) {
      [canvas.width, canvas.height] = [width, height];
      this._bars = this._count(Math.max(1, Math.floor(canvas.clientWidth / 4)));
    }
    const context = canvas.getContext("2d"), css = (rgb) => `rgb(${rgb.map((value) => Math.round(255 * value)).join(" ")})`;
    context.clearRect(0, 0, width, height);
    const bars = this._bars, wide = width / bars.length, most = Math.max(1, ...bars.map(([pairs, walls]) => pairs + walls));
    bars.forEach(([pairs, walls], place) => {
      const tall = (count) => (count / most) * (height - 2 * scale);
      context.fillStyle = css(colours.met);
      context.fillRect(place * wide, height - tall(pairs), Math.max(1, wide - scale), tall(pairs));
      context.fillStyle = css(colours.wall);
      context.fillRect(place * wide, height - tall(pairs + walls), Math.max(1, wide - scale), tall(walls));
    });
    context.fillStyle = css(colours.ink);
    const at = recording.duration ? (time / recording.duration) * width : 0;
    context.fillRect(Math.min(width - 2 * scale, Math.max(0, at - scale)), 0, 2 * scale, height);
  }

  /** Hits between bodies and at walls in each of so many equal spans. */
  _count(spans) {
    const bars = Array.from({ length: spans }, () => [0, 0]), { recording } = this;
    for (let hit = 0; hit < recording.hits; hit++) {
      const span = Math.floor((recording.hit_times[hit] / (recording.duration || 1)) * spans);
      bars[Math.min(spans - 1, span)][recording.hit_second[hit] >= 0 ? 0 : 1] += 1;
    }
    return bars;
  }
}
