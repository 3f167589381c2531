// Plays the rendered force above 30 Hz as short grains of the recorded signal at the time of the picture. A slowed
// replay therefore keeps its pitch, a jump takes effect at once, and a paused replay is silent.

const GRAIN_S = 0.08, HOP_S = GRAIN_S / 2, AHEAD_S = 0.12;
// Rms of the loudest run in contact at the limiter's input, whose range is -1 … 1. The limiter compresses landings,
// which are many times louder.
const LOUDNESS = 0.12;

class Sound {
  constructor() {
    this.on = false;
    this.volume = 0.15;
    this.grains = 0; // number of grains that were started, for tests
    this.buffers = new Map();
  }

  /** Call this first from a click or a key event, because browsers start sound only after a user's action. */
  start() {
    if (!this.context) {
      this.context = new AudioContext();
      this.gain = this.context.createGain();
      const limiter = this.context.createWaveShaper();
      limiter.curve = Float32Array.from({length: 2049}, (_, i) => Math.tanh(4 * (i / 1024 - 1)) / 4);
      this.master = this.context.createGain();
      this.gain.connect(limiter).connect(this.master).connect(this.context.destination);
      this.setVolume(this.volume);
    }
    this.context.resume();
    this.on = true;
  }

  stop() { this.on = false; }

  setVolume(volume) {
    this.volume = volume;
    // The limiter's output is at most 1/4 of full scale.
    if (this.master) this.master.gain.value = 4 * volume;
  }

  /** Returns a stream of the sound for a clip; null if sound was never switched on. */
  stream() {
    if (!this.context) return null;
    const target = this.context.createMediaStreamDestination();
    this.master.connect(target);
    return target.stream;
  }

  /** Called for every frame during playback. Starts the grains of `recording` for the next AHEAD_S seconds. `time`:
   *  time of the picture [s]. `recordings`: all shown runs, which share one gain, so that their loudness can be
   *  compared. */
  follow(recording, recordings, time, speed) {
    if (!this.on || !recording.sound) return;
    const now = this.context.currentTime;
    // Scale the loudest run to LOUDNESS.
    const loudest = Math.max(...recordings.map((r) => (r.sound ? r.sound.rms : 0)));
    this.gain.gain.value = loudest > 0 ? LOUDNESS / loudest : 0;
    if (!(this.next > now) || this.next > now + 2 * AHEAD_S) this.next = now;
    while (this.next < now + AHEAD_S) {
      this.grain(recording, this.next, time + (this.next - now) * speed);
      this.next += HOP_S;
    }
  }

  grain(recording, when, time) {
    const at = time - recording.sound.start, buffer = this.bufferOf(recording);
    if (at < 0 || at >= buffer.duration) return;
    const source = this.context.createBufferSource(), window = this.context.createGain();
    source.buffer = buffer;
    // Fade in and out linearly: the windows of overlapping grains add up to one.
    window.gain.setValueAtTime(0, when);
    window.gain.linearRampToValueAtTime(1, when + HOP_S);
    window.gain.linearRampToValueAtTime(0, when + GRAIN_S);
    source.connect(window).connect(this.gain);
    source.start(when, at, GRAIN_S);
    ++this.grains;
  }

  bufferOf(recording) {
    if (!this.buffers.has(recording)) {
      const {rate, scale, samples} = recording.sound;
      const steps = new Int16Array(bytesOf(samples)), factor = Math.ceil(16000 / rate);
      const fine = resampled(Float32Array.from(steps, (step) => step * scale), factor);
      // Audio contexts support buffers of 8 to 96 kHz.
      const buffer = this.context.createBuffer(1, fine.length, Math.min(96000, rate * factor));
      buffer.copyToChannel(fine, 0);
      this.buffers.set(recording, buffer);
    }
    return this.buffers.get(recording);
  }
}

/** Returns the samples at `factor` times their rate. Interpolates by a Hann-windowed sinc of eight samples on each
 *  side, which suppresses mirrored tones. */
function resampled(samples, factor) {
  const reach = 8, out = new Float32Array(samples.length * factor);
  for (let phase = 0; phase < factor; ++phase) {
    const weights = Array.from({length: 2 * reach}, (_, k) => {
      const x = k - reach + 1 - phase / factor, y = Math.PI * x;
      return (x ? Math.sin(y) / y : 1) * 0.5 * (1 + Math.cos(y / reach));
    });
    for (let i = 0; i < samples.length; ++i) {
      let sum = 0;
      for (let k = 0; k < 2 * reach; ++k) sum += weights[k] * (samples[i + k - reach + 1] || 0);
      out[i * factor + phase] = sum;
    }
  }
  return out;
}
