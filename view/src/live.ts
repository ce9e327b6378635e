// A flight of `cargo sitl --view`.

import type { Ask, Listener, Message, Source } from "./types";

/** Between two signs of life, ms: they are sent as snapshots come, since timers of a hidden page sleep. */
const BEAT = 500;
const AGAIN = 1000;

export class Live implements Source {
  readonly kind = "live";
  private socket: WebSocket | null = null;
  private beatAt = 0;
  private isClosed = false;

  constructor(private readonly listener: Listener, private readonly connected: (is: boolean) => void) {
    this.connect();
  }

  private connect(): void {
    const socket = new WebSocket(`ws://${location.host}/ws`);
    this.socket = socket;
    socket.onopen = () => {
      this.connected(true);
      this.ask({ do: "beat" });
    };
    socket.onmessage = (event) => this.receive(String(event.data));
    socket.onclose = () => {
      this.connected(false);
      if (!this.isClosed) window.setTimeout(() => this.connect(), AGAIN);
    };
  }

  private receive(text: string): void {
    if (this.isClosed) return;
    const message = JSON.parse(text) as Message;
    if (message.type === "panel") this.listener.panel(message);
    else if (message.type === "snapshot") this.listener.snapshot(message);
    else this.listener.note(message.text);
    const now = performance.now();
    if (now > this.beatAt + BEAT) {
      this.beatAt = now;
      this.ask({ do: "beat" });
    }
  }

  ask(ask: Ask): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(ask));
  }

  close(): void {
    this.isClosed = true;
    this.socket?.close();
  }
}
