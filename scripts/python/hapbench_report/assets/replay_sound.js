// The force above 30 Hz, heard: grains of the recorded signal follow the time of the picture, so that a slowed replay keeps
// its pitch, a jump is heard at once, and nothing sounds while the picture stands.

const GRAIN_S = 0.08, HOP_S = GRAIN_S / 2, AHEAD_S = 0.12;
// Of full scale: the rms of the loudest run. Landings, many times louder, are bent down by the limiter.
const LOUDNESS = 0.12;

class Sound {
  constructor() {
    this.on = false;
    this.volume = 0.15;
    this.grains = 0; // started, for programs
    this.buffers = new Map();
  }

  /** Must first be called from a click or a key: browsers start no sound without one. */
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
    // The limiter gives a quarter of full scale.
    if (this.master) this.master.gain.value = 4 * volume;
  }

  /** Where a clip takes the sound from; null before it was first switched on. */
  stream() {
    if (!this.context) return null;
    const target = this.context.createMediaStreamDestination();
    this.master.connect(target);
    return target.stream;
  }

  /** Called for every frame while playing: sounds what the next moment of the picture shows. `recordings` are all that can
   *  be switched between: one gain for them, so that they can be compared. */
  follow(recording, recordings, time, speed) {
    if (!this.on || !recording.sound) return;
    const now = this.context.currentTime;
    // The limiter reads -1 ... 1.
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
    // Two neighbouring windows add up to one.
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
      // Contexts play buffers of 8 to 96 kHz.
      const buffer = this.context.createBuffer(1, fine.length, Math.min(96000, rate * factor));
      buffer.copyToChannel(fine, 0);
      this.buffers.set(recording, buffer);
    }
    return this.buffers.get(recording);
  }
}

/** So many times as many samples, by a sinc under a Hann window of eight samples to each side: no mirrored tones. */
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
