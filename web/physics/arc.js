// Types of a flight between two impacts. Nothing loads this file.

/**
 * @typedef {object} Pose
 * @property {number} x of the centre of gravity, m
 * @property {number} y
 * @property {number} theta rad
 *
 * @typedef {object} Arc the flight that starts at `t`
 * @property {number} t
 * @property {number} x
 * @property {number} y
 * @property {number} theta
 * @property {number} x_dot
 * @property {number} y_dot
 * @property {number} theta_dot
 * @property {number} duration s; 0 when there is no flight
 */

export {};
