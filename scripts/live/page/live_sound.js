// The force above 30 Hz, heard as it is rendered: a newton is always as loud, so that laws compare by ear. Clicks where
// contact begins and ends.

/** Amplitude of full scale for 1 N [dB] at a gain of 0 dB. */
const NEWTON_DB = -20;
const DELAY_S = 0.06, LONGEST_S = 0.3;

/** The rendered force of one run above 30 Hz: along the direction in which it is strongest of late, and its rms. */
class Vibration {
  constructor(rate) {
    this.direction = [0.6, 0.6, 0.53];
    this.power = 0;
    this.share = 1 - Math.exp(-1 / (0.5 * rate));
  }

  /** The signed size of the next sample along that direction. */
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

/** Plays samples at the loop's rate, each of two channels in its ear; runs in the audio thread. */
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

  /** From a click or a key: browsers start no sound without one. */
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
    // Not awaited: without a device of sound some browsers never answer.
    this.context.resume();
    this.on = true;
  }

  stop() { this.on = false; }

  setGain(db) {
    this.gainDb = db;
    // The limiter reads -1 ... 1, where it is straight up to a quarter.
    if (this.gain) this.gain.gain.value = 10 ** ((NEWTON_DB + db) / 20) / 4;
  }

  /** Samples [N] of one run, or of two for the two ears. */
  play(channels) {
    if (this.on && channels[0].length) this.player.port.postMessage(channels);
  }
}

/** A tick of so many newtons that decays, added where contact begins (bright) or ends (dull). */
function addClick(samples, at, rate, begins) {
  const pitch = begins ? rate / 4 : rate / 10;
  for (let i = 0; i < 0.008 * rate && at + i < samples.length; ++i)
    samples[at + i] += 0.5 * Math.exp(-i / (0.002 * rate)) * Math.sin(2 * Math.PI * pitch * i / rate);
}
