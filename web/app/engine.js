// Workers as the page sees them: questions with answers, progress, and an end at any time.

const source = URL.createObjectURL(new Blob([await globalThis.unpack('worker')], { type: 'text/javascript' }));
const packed = globalThis.packed('wasm');

export class Cancelled extends Error {}

export class Engine {
  // computing: with scree in it; else for distances alone
  constructor(computing = true, onProgress = () => {}) {
    Object.assign(this, { computing, onProgress });
    this.start();
  }

  start() {
    this.last = 0;
    this.waiting = new Map();
    this.worker = new Worker(source);
    this.worker.onerror = (event) => this.fail(new Error(event.message ?? 'the worker failed'));
    this.worker.onmessage = ({ data }) => this.hear(data);
    if (!this.computing) return;
    this.ready = this.ask({ do: 'load', packed });
    this.ready.catch(() => {});
  }

  hear({ id, result, error, progress }) {
    if (progress) {
      this.onProgress(...progress);
      return;
    }
    const { resolve, reject } = this.waiting.get(id);
    this.waiting.delete(id);
    if (error === undefined) resolve(result);
    else reject(new Error(error));
  }

  fail(error) {
    this.waiting.forEach(({ reject }) => reject(error));
    this.waiting.clear();
  }

  ask(message, transfer = []) {
    return new Promise((resolve, reject) => {
      const id = ++this.last;
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ ...message, id }, transfer);
    });
  }

  // A running computation hears nothing: it ends with its worker, and another one begins.
  cancel() {
    this.worker.terminate();
    this.fail(new Cancelled('cancelled'));
    this.start();
  }

  end() {
    this.worker.terminate();
    this.fail(new Cancelled('ended'));
  }
}
