// The range of a run's speed, in times real time.

export const SLOWEST = 0.05;
export const FASTEST = 20;
