// Incremental reader of run.stream: 8 bytes "ALIDSTR1", then for each message its length (u32, little-endian), 4 zero
// bytes, the message, and zeros up to a multiple of 8.
import { DecodeError } from './verify.ts';

const MAGIC = 'ALIDSTR1';
const MOST = 256 * 1024 * 1024; // bytes per message

export class StreamFileReader {
  private pending: Uint8Array[] = [];
  private size = 0;
  private started = false;

  // Returns the messages completed by this chunk; each starts at a multiple of 8 of its buffer.
  push(chunk: Uint8Array): Uint8Array[] {
    this.pending.push(chunk);
    this.size += chunk.byteLength;
    const messages: Uint8Array[] = [];
    if (!this.started) {
      const head = this.peek(8);
      if (!head) return messages;
      if (String.fromCharCode(...head) !== MAGIC) throw new DecodeError('this is not a recorded stream: it does not begin with ' + MAGIC);
      this.take(8);
      this.started = true;
    }
    for (;;) {
      const head = this.peek(8);
      if (!head) return messages;
      const view = new DataView(head.buffer);
      const length = view.getUint32(0, true);
      if (length > MOST || view.getUint32(4, true) !== 0) throw new DecodeError('the recorded stream is damaged');
      const padded = 8 * Math.ceil(length / 8);
      if (this.size < 8 + padded) {
        // wait for the padding, which alone may be missing at the end of an interrupted file
        return messages;
      }
      this.take(8);
      messages.push(this.take(padded).subarray(0, length));
    }
  }

  // Number of bytes of an incomplete message, as in a truncated file.
  get rest(): number { return this.size; }

  private peek(count: number): Uint8Array<ArrayBuffer> | null {
    if (this.size < count) return null;
    const bytes = this.gather(count);
    return bytes;
  }

  private gather(count: number): Uint8Array<ArrayBuffer> {
    const bytes = new Uint8Array(count);
    let at = 0;
    for (const chunk of this.pending) {
      const part = chunk.subarray(0, count - at);
      bytes.set(part, at);
      at += part.byteLength;
      if (at === count) break;
    }
    return bytes;
  }

  private take(count: number): Uint8Array<ArrayBuffer> {
    const bytes = this.gather(count);
    this.size -= count;
    let left = count;
    while (left > 0) {
      const chunk = this.pending[0];
      if (chunk.byteLength > left) {
        this.pending[0] = chunk.subarray(left);
        break;
      }
      left -= chunk.byteLength;
      this.pending.shift();
    }
    return bytes;
  }
}
