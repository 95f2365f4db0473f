// Checks that bytes are a well-formed FlatBuffer of the schema, as the C++ verifier does: every offset, vector and
// string is inside and aligned. flatc generates no verifier for TypeScript, and its accessors misbehave on malformed
// data.
import { SCHEMA } from '../generated/schema.ts';

export class DecodeError extends Error {
  override name = 'DecodeError';
}

interface Field { name: string; kind: string; size?: number; align?: number; table?: string; tables?: readonly string[] }
const TABLES = SCHEMA.tables as unknown as Record<string, readonly Field[]>;

// `bytes` must start at a multiple of 8 of its buffer. Throws DecodeError.
export function verify(bytes: Uint8Array): void {
  if (bytes.byteLength < 8) throw new DecodeError('shorter than a message can be');
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  for (let i = 0; i < 4; ++i) {
    if (bytes[4 + i] !== SCHEMA.identifier.charCodeAt(i)) throw new DecodeError('not a message of this stream');
  }
  new Verifier(view).table(SCHEMA.root, view.getUint32(0, true));
}

class Verifier {
  // Objects may be shared by several offsets, so that a small message could expand to a huge one. Limits the visited
  // bytes to about four times the message's size.
  private budget: number;

  constructor(private readonly view: DataView) {
    this.budget = 4 * view.byteLength + 1024;
  }

  table(name: string, at: number): void {
    this.inside(at, 4, 4, name);
    const vtable = at - this.view.getInt32(at, true);
    this.inside(vtable, 4, 2, name);
    const vtableSize = this.view.getUint16(vtable, true);
    if (vtableSize < 4 || vtableSize % 2 !== 0) throw new DecodeError(`${name}: a vtable of ${vtableSize} bytes`);
    this.inside(vtable, vtableSize, 2, name);
    const tableSize = this.view.getUint16(vtable + 2, true);
    if (tableSize < 4) throw new DecodeError(`${name}: a table of ${tableSize} bytes`);
    this.inside(at, tableSize, 4, name);
    this.spend(tableSize);
    const fields = TABLES[name];
    let unionType = 0;
    for (let slot = 0; slot < fields.length && 6 + 2 * slot <= vtableSize; ++slot) {
      const offset = this.view.getUint16(vtable + 4 + 2 * slot, true);
      if (offset === 0) continue;
      const field = fields[slot];
      const size = field.kind === 'scalar' ? field.size! : 4;
      if (offset < 4 || offset + size > tableSize) throw new DecodeError(`${name}.${field.name}: outside its table`);
      this.inside(at + offset, size, field.kind === 'scalar' ? field.align! : 4, `${name}.${field.name}`);
      if (field.kind === 'scalar') {
        if (size === 1) unionType = this.view.getUint8(at + offset);
        continue;
      }
      this.pointed(name, field, at + offset, unionType);
    }
  }

  private pointed(name: string, field: Field, from: number, unionType: number): void {
    const what = `${name}.${field.name}`;
    const at = this.follow(from);
    switch (field.kind) {
      case 'table':
        return this.table(field.table!, at);
      case 'union': {
        const table = field.tables![unionType - 1];
        if (table === undefined) throw new DecodeError(`${what}: no message of kind ${unionType} is known`);
        return this.table(table, at);
      }
      case 'string':
        return void this.vector(at, 1, 1, what);
      case 'vector':
        return void this.vector(at, field.size!, field.align!, what);
      case 'tables': {
        const count = this.vector(at, 4, 4, what);
        for (let i = 0; i < count; ++i) this.table(field.table!, this.follow(at + 4 + 4 * i));
        return;
      }
    }
  }

  private vector(at: number, size: number, align: number, what: string): number {
    this.inside(at, 4, 4, what);
    const count = this.view.getUint32(at, true);
    this.inside(at + 4, count * size, align, what);
    this.spend(4 + count * size);
    return count;
  }

  private follow(at: number): number {
    const offset = this.view.getUint32(at, true);
    if (offset === 0) throw new DecodeError('an offset to itself');
    return at + offset;
  }

  private inside(at: number, size: number, align: number, what: string): void {
    if (at < 0 || at + size > this.view.byteLength) throw new DecodeError(`${what}: outside the message`);
    if (size > 0 && at % align !== 0) throw new DecodeError(`${what}: not aligned`);
  }

  private spend(bytes: number): void {
    this.budget -= bytes;
    if (this.budget < 0) throw new DecodeError('refers to the same bytes too often');
  }
}
