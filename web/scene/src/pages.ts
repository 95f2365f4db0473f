// Records of a fixed size in pages of 1024. A clone shares the pages; who writes to a shared page gets a copy of its own first.
// So keeping a state costs what changes after it, and a reader that remembers a page and its version knows whether to read it again.

export const PAGE = 1024; // records

export interface Page {
  readonly f32: Float32Array;
  readonly u32: Uint32Array;
  readonly f64: Float64Array;
  version: number; // other after each write
  owner: object; // who may write without copying
}

let versions = 0;

function makePage(buffer: ArrayBuffer, owner: object): Page {
  return {
    f32: new Float32Array(buffer), u32: new Uint32Array(buffer), f64: new Float64Array(buffer),
    version: ++versions, owner,
  };
}

export class Pages {
  readonly pages: Page[] = [];
  length = 0;
  private owner = {};

  constructor(readonly bytes: number) {} // of a record: a multiple of 4, of 8 if it holds doubles

  clone(): Pages {
    const copy = new Pages(this.bytes);
    copy.pages.push(...this.pages);
    copy.length = this.length;
    this.owner = {}; // what there is belongs to nobody from now on
    return copy;
  }

  // The page of record i, to be written to. i = length adds a record.
  write(i: number): Page {
    const number = Math.floor(i / PAGE);
    if (i >= this.length) this.length = i + 1;
    let page = this.pages[number];
    if (!page) {
      page = makePage(new ArrayBuffer(this.bytes * PAGE), this.owner);
      this.pages[number] = page;
    } else if (page.owner !== this.owner) {
      page = makePage((page.u32.buffer as ArrayBuffer).slice(0), this.owner);
      this.pages[number] = page;
    } else {
      page.version = ++versions;
    }
    return page;
  }

  read(i: number): Page {
    return this.pages[Math.floor(i / PAGE)];
  }

  truncate(length: number): void {
    this.length = length;
    this.pages.length = Math.ceil(length / PAGE);
  }
}
