// In place of the simulator, in the page that `cargo sitl --view` serves: there the flight is the server's.

export class Simulation {
  constructor(_scenario: string, _seed: number) {
    throw new Error("this page has no simulator");
  }
  step(_ms: number): void {}
  send(_ask: string): void {}
  panel(): string {
    return "";
  }
  snapshot(): string {
    return "";
  }
  note(): string | undefined {
    return undefined;
  }
  free(): void {}
}

export default async function init(_options: { module_or_path: Uint8Array }): Promise<void> {}
