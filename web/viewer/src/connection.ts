// WebSocket connection to a running program's stream; reconnects automatically.
export type Ask = 'pause' | 'resume' | 'step' | 'whole';

const WAITS = [500, 1000, 2000, 4000]; // ms before reconnecting

export interface ConnectionEvents {
  opened(): void;
  message(bytes: Uint8Array): void;
  closed(): void;
}

export class Connection {
  private socket: WebSocket | null = null;
  private tries = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly events: ConnectionEvents) {
    this.connect();
  }

  ask(what: Ask): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ do: what }));
  }

  close(): void {
    clearTimeout(this.timer);
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  private connect(): void {
    const url = new URL('stream', location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    url.search = query();
    url.hash = '';
    const socket = new WebSocket(url);
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.tries = 0;
      this.events.opened();
    };
    socket.onmessage = ({ data }) => {
      if (data instanceof ArrayBuffer) this.events.message(new Uint8Array(data));
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      this.events.closed();
      this.timer = setTimeout(() => this.connect(), WAITS[Math.min(this.tries++, WAITS.length - 1)]);
    };
  }
}

// The token of the page's own URL, to be added to all requests.
export function query(): string {
  const token = new URLSearchParams(location.search).get('token');
  return token === null ? '' : '?' + new URLSearchParams({ token });
}
