// Keeps the screen on while a session runs, where the device permits it.
export class Wake {
  private lock: WakeLockSentinel | null = null;

  async hold(): Promise<void> {
    try {
      this.lock = await navigator.wakeLock?.request('screen') ?? null;
    } catch {
      // not permitted now (low battery): the screen may turn off
    }
  }

  release(): void {
    void this.lock?.release();
    this.lock = null;
  }
}
