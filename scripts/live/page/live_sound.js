// Plays the rendered force above 30 Hz during the simulation. 1 N always has the same loudness, so that force laws can
// be compared by ear. Clicks mark where contact begins and ends.

/** Amplitude of 1 N [dB relative to full scale] at a gain of 0 dB. */
const NEWTON_DB = -20;
const DELAY_S = 0.06, LONGEST_S = 0.3;

/** Rendered force of one run above 30 Hz: its component along a slowly adapting strongest direction, and its rms
 *  (average with a time constant of 0.5 s). `rate`: samples per second. */
class Vibration {
  constructor(rate) {
    this.direction = [0.6, 0.6, 0.53];
    this.power = 0;
    this.share = 1 - Math.exp(-1 / (0.5 * rate));
  }

  /** Returns the component [N] of the next force `high` [N] along the direction, then adapts direction and rms. */
  next(high) {
    const along = high.reduce((sum, h, i) => sum + h * this.direction[i], 0);
    const size2 = high.reduce((sum, h) => sum + h * h, 0);
    this.power += this.share * (size2 - this.power);
    if (size2 > 0) {
      const turned = this.direction.map((d, i) => d + 0.01 * along * high[i] / size2), length = Math.hypot(...turned);
      this.direction = turned.map((d) => d / length);
    }
    return along;
  }

  get rms() { return Math.sqrt(this.power); }
}

/** Code of the audio thread: resamples the loop's samples to the rate of the audio device. Plays one run in both ears,
 *  or one of two runs in each ear. */
const PLAYER = `
class Player extends AudioWorkletProcessor {
  constructor({processorOptions: {rate, delay, longest}}) {
    super();
    this.ratio = rate / sampleRate;
    this.delay = delay * rate;
    this.size = Math.ceil(4 * longest * rate);
    this.ring = [0, 1].map(() => new Float32Array(this.size));
    this.write = 0;
    this.read = null;
    this.longest = longest * rate;
    this.port.onmessage = ({data}) => {
      for (let i = 0; i < data[0].length; ++i, ++this.write)
        this.ring.forEach((ring, c) => { ring[this.write % this.size] = data[c % data.length][i]; });
      if (this.read === null || this.write - this.read > this.longest) this.read = this.write - this.delay;
    };
  }

  // Hann-windowed sinc over eight samples: no mirrored tones.
  at(ring, x) {
    const first = Math.floor(x) - 3;
    let sum = 0;
    for (let k = first; k < first + 8; ++k) {
      const d = x - k, y = Math.PI * d;
      const weight = (Math.abs(d) < 1e-6 ? 1 : Math.sin(y) / y) * 0.5 * (1 + Math.cos(y / 4));
      if (Math.abs(d) < 4) sum += weight * ring[((k % this.size) + this.size) % this.size];
    }
    return sum;
  }

  process(inputs, [out]) {
    const end = this.write - 5;
    for (let i = 0; i < out[0].length; ++i) {
      const sounding = this.read !== null && this.read > 3 && this.read < end;
      out.forEach((channel, c) => { channel[i] = sounding ? this.at(this.ring[c], this.read) : 0; });
      if (sounding) this.read += this.ratio;
    }
    if (this.read !== null && this.read >= end) this.read = null;
    return true;
  }
}
registerProcessor("player", Player);
`;

class LiveSound {
  constructor() {
    this.on = false;
    this.gainDb = 0;
  }

  /** Call this from a click or a key event, because browsers start sound only after a user's action. `rate`: steps per
   *  second. */
  async start(rate) {
    if (!this.context) {
      this.context = new AudioContext();
      await this.context.audioWorklet.addModule(`data:text/javascript,${encodeURIComponent(PLAYER)}`);
      const limiter = this.context.createWaveShaper();
      limiter.curve = Float32Array.from({length: 4097}, (_, i) => Math.tanh(4 * (i / 2048 - 1)) / 4);
      this.gain = this.context.createGain();
      this.out = this.context.createGain();
      this.out.gain.value = 4;
      this.gain.connect(limiter).connect(this.out).connect(this.context.destination);
      this.setGain(this.gainDb);
    }
    if (this.rate !== rate) {
      if (this.player) this.player.disconnect();
      this.player = new AudioWorkletNode(this.context, "player",
        {outputChannelCount: [2], processorOptions: {rate, delay: DELAY_S, longest: LONGEST_S}});
      this.player.connect(this.gain);
      this.rate = rate;
    }
    // resume() is not awaited: without an audio device its promise never resolves in some browsers.
    this.context.resume();
    this.on = true;
  }

  stop() { this.on = false; }

  setGain(db) {
    this.gainDb = db;
    // Full scale is 1/4 at the limiter's input, where tanh(4 x) / 4 compresses it by a quarter. `out` multiplies by 4.
    if (this.gain) this.gain.gain.value = 10 ** ((NEWTON_DB + db) / 20) / 4;
  }

  /** Plays samples [N]. `channels`: the samples of one run, or of two runs, one run per ear. */
  play(channels) {
    if (this.on && channels[0].length) this.player.port.postMessage(channels);
  }
}

/** Adds a click at sample `at`: a tone of 0.5 N that decays with a time constant of 2 ms. Its pitch is rate / 4 [Hz]
 *  where contact begins, and rate / 10 where contact ends. */
function addClick(samples, at, rate, begins) {
  const pitch = begins ? rate / 4 : rate / 10;
  for (let i = 0; i < 0.008 * rate && at + i < samples.length; ++i)
    samples[at + i] += 0.5 * Math.exp(-i / (0.002 * rate)) * Math.sin(2 * Math.PI * pitch * i / rate);
}
