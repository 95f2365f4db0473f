// Fixed-size records in pages of 1024 with copy-on-write: a clone shares the pages until one is written to. Storing a
// state therefore costs what changes after it, and a reader can detect changed pages by their version.

export const PAGE = 1024; // records per page

export interface Page {
  readonly f32: Float32Array;
  readonly u32: Uint32Array;
  readonly f64: Float64Array;
  version: number; // changes with every write
  owner: object; // may write without copying
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

  constructor(readonly bytes: number) {} // per record; a multiple of 4, and of 8 if it holds doubles

  clone(): Pages {
    const copy = new Pages(this.bytes);
    copy.pages.push(...this.pages);
    copy.length = this.length;
    this.owner = {}; // both copies must now copy before writing
    return copy;
  }

  // The page of record i for writing. i = length appends a record.
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
