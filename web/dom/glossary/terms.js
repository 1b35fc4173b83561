// The words and symbols that the page explains. Longer explanations are in docs/physics.md.

export const TERMS = {
  elliptic: {
    title: 'Elliptic',
    text: 'A small tilt turns into a swing that neither grows nor dies out. The eigenvalues of the angle lie on the unit circle.',
  },
  hyperbolic: {
    title: 'Hyperbolic',
    text: 'A small tilt grows by the same factor at every bounce, so the body falls. An eigenvalue of the angle lies off the unit circle.',
  },
  parabolic: {
    title: 'Parabolic',
    text: 'The edge between the two: a double eigenvalue at +1 or −1. Terms beyond the linear ones decide.',
  },
  stable: {
    title: 'Stable in place',
    text: 'Every small deviation dies out, the position included. It takes a feedback of the whole state.',
  },
  unstable: {
    title: 'Unstable',
    text: 'Some small deviation grows from bounce to bounce until the body falls.',
  },
  attracting: {
    title: 'Weakly attracting',
    text: 'The linear analysis cannot decide, and the next terms make small swings shrink, more slowly than by a constant factor.',
  },
  repelling: {
    title: 'Weakly unstable',
    text: 'The linear analysis cannot decide, and the next terms make small swings grow, slowly at first.',
  },
  bounded: {
    title: 'Bounded beyond the boundary',
    text: 'Upright is unstable, but the swing that grows from it stays small: the loss of stability is soft.',
  },
  residue: {
    title: 'Residue',
    sign: 'R',
    text: 'Greene’s residue: (2 − trace)/4 of the part of the linear map that moves the angle. From 0 to 1 the body keeps its balance.',
  },
  kappa: {
    title: 'Tilt gain',
    sign: 'κ',
    text: 'The table tilts by κ times the angle of the body at the contact: α = κθ.',
  },
  'kappa-critical': {
    title: 'Critical tilt gain',
    sign: 'κ_c',
    text: 'The largest tilt gain that balances. Above it an eigenvalue passes −1, and the body swings over.',
  },
  'kappa-energy': {
    title: 'Energy gain',
    sign: 'κ_E',
    text: 'How strongly the table strikes harder when the bounce is too low, and softer when it is too high.',
  },
  alpha: {
    title: 'Tilt of the table',
    sign: 'α',
    text: 'Angle of the table at a contact, counter-clockwise from level.',
  },
  beta: {
    title: 'Angle from the normal',
    sign: 'β',
    text: 'Angle of the body from the normal of the table: β = θ − α.',
  },
  theta: {
    title: 'Angle of the body',
    sign: 'θ',
    text: 'Angle from upright, counter-clockwise. At 0 the centre of gravity is straight above the contact point.',
  },
  rho: {
    title: 'Radius of gyration',
    sign: 'ρ',
    text: 'How far out the mass lies: the moment of inertia about the centre of gravity is mass × ρ².',
  },
  l: {
    title: 'Contact distance',
    sign: 'l',
    text: 'Distance from the centre of gravity to the point that touches the table.',
  },
  e: {
    title: 'Restitution',
    sign: 'e',
    text: 'The part of the approach speed that a bounce gives back: 1 loses nothing, 0 sticks.',
  },
  mu: {
    title: 'Friction',
    sign: 'μ',
    text: 'Coulomb’s coefficient: the impulse along the table is at most μ times that across it.',
  },
  tau: { title: 'Flight time', sign: 'τ', text: 'Time from one contact to the next.' },
  'rotation-angle': {
    title: 'Rotation',
    sign: 'σ',
    text: 'Angle by which a small deviation turns at every bounce in the plane of θ and θ̇.',
  },
  basin: { title: 'Basin', text: 'All starts whose runs survive. Here: the release angles, at rest.' },
  resonance: {
    title: 'Resonance',
    text: 'The swing comes back after a few bounces: the rotation number is near a fraction with a small denominator. Near one, the basin may shrink.',
  },
  'rotation-number': {
    title: 'Rotation number',
    text: 'Mean turns per bounce of the state about the upright bounce, measured along the run.',
  },
  'spectral-radius': {
    title: 'Spectral radius',
    sign: 'max |λ|',
    text: 'Largest modulus of the eigenvalues: the factor by which small deviations grow or shrink per bounce. Below 1 all of them die out.',
  },
  eigenvalue: {
    title: 'Eigenvalue',
    sign: 'λ',
    text: 'Factor by which one kind of small deviation changes per bounce. A complex pair turns and scales.',
  },
  wilson: {
    title: 'Wilson interval',
    text: 'Range in which the true share lies with 95 % confidence, given how many runs were made. More runs make it narrower.',
  },
  median: { title: 'Median', text: 'Half of the runs lie below it, half above.' },
  'half-life': {
    title: 'Half-life',
    text: 'Contacts in which half of the runs still going end, from the second half of the contacts.',
  },
  'at-risk': { title: 'At risk', text: 'Runs that reach a contact: those that have not ended before it.' },
  lqr: {
    title: 'Linear-quadratic regulator (LQR)',
    text: 'The law with the least sum of weighted squares of deviations and of tilt. A larger weight makes that deviation smaller; a larger weight of the tilt makes the table calmer.',
  },
  riccati: {
    title: 'Riccati equation',
    text: 'The equation whose solution gives the best law. Its residual says how exactly it was solved; it should be tiny.',
  },
  'closed-loop': { title: 'Closed loop', text: 'The bounce together with its feedback law.' },
  'gain-margin': { title: 'Gain margin', text: 'Factors by which the whole law may be off before it no longer holds.' },
  drift: {
    title: 'Drift',
    text: 'Constant mean sideways speed of a balanced run. Without feedback of the position nothing stops it.',
  },
  'fixed-point': { title: 'Fixed point', text: 'The bounce that repeats exactly: upright, in place.' },
  orbit: { title: 'Periodic orbit', text: 'A motion that repeats after a number of bounces, its period.' },
  soft: { title: 'Soft boundary', text: 'Beyond the boundary the body settles on a small swing nearby.' },
  hard: { title: 'Hard boundary', text: 'Beyond the boundary nothing nearby holds the body: it falls.' },
  fold: { title: 'Fold', text: 'The branch turns back: a stable and an unstable orbit meet and vanish.' },
  'period-doubling': {
    title: 'Period doubling',
    text: 'An eigenvalue passes −1: an orbit of twice the period branches off.',
  },
  chaos: {
    title: 'Chaotic',
    text: 'Nearby runs part exponentially, so a run can be predicted for a few bounces only.',
  },
  predictable: {
    title: 'Predictable bounces',
    text: 'Bounces until rounding errors, multiplied along the run, have reached a thousandth of the speed of the bounce.',
  },
  lyapunov: {
    title: 'First Lyapunov coefficient',
    sign: 'ℓ',
    text: 'Growth of a swing in third order, where the linear growth is zero. Below 0 swings shrink.',
  },
  pareto: { title: 'Pareto front', text: 'The points that no other method beats in both cost and error.' },
  rms: { title: 'RMS', text: 'Root of the mean square: the typical size of a deviation.' },
  residual: { title: 'Residual', text: 'Measured less simulated at the same bounce.' },
  impulse: {
    title: 'Impulse per mass',
    text: 'The strike’s push divided by the mass: the change of speed that it makes, in m/s.',
  },
  'stick-cone': { title: 'Stick cone', text: 'The angles at which friction can hold the contact point on the table.' },
};
