// The types that several files of the page share. They are known everywhere, so that no file imports them.

// Of the contract.

type Case = import('contract').Preset;
type Derived = import('contract').Derived;
type Field = import('contract').Field;
type NextStrike = import('contract').LiveNextStrike;
type ProblemError = import('contract').ProblemError;
type Stability = import('contract').Stability;
type Trajectory = import('contract').Trajectory;
/** With the end in contact, if there is one. */
type Outcome = import('contract').Outcome & { contact?: import('contract').HoldEnd };

// Of classes and tables.

type CanvasView = import('../../web/charts/surface.js').CanvasView;
type Column = import('../../web/run/impacts.js').Column;
type Form = import('../../web/form/form.js').Form;
type Grid = import('../../web/panels/map/grid.js').Grid;
type Impact = import('../../web/run/impacts.js').Impact;
type ImpactPlot = import('../../web/charts/impacts/plots.js').ImpactPlot;
type Impacts = import('../../web/run/impacts.js').Impacts;
type Lasting = import('../../web/run/impacts.js').Lasting;
type Page = import('../../web/app/page.js').Page;
type Problem = import('../../web/api/client.js').Problem;
type Releases = ReturnType<typeof import('../../web/charts/impacts/plot-interaction.js').bringReleases>;
type Rig = import('../../web/rig/rig.js').Rig;
type Run = import('../../web/run/run.js').Run;
type RunState = import('../../web/run/run-state.js').RunState;
type ScenePage = import('../../web/panels/scene-page.js').ScenePage;
type Surface = import('../../web/charts/surface.js').Surface;
type Tone = import('../../web/panels/parts.js').Tone;

/** Nested as in the contract, as far as it is set. */
type Scene = Record<string, any>;

/** A result in a line. */
type Result = { tone: Tone; words: string } | null;

/** A refusal of one message to a run. */
type Refusal = { title: string; detail: string; errors: ProblemError[] };

// Drawing.

/** A colour of the style sheet by its name there, or white. */
type Colour =
  | ('ink' | 'muted' | 'line' | 'faint' | 'surface' | 'accent' | 'strike' | 'good' | 'caution' | 'survives' | 'falls' | 'rests')
  | ('series-0' | 'series-1' | 'series-2' | 'series-3' | 'measured' | 'white');

type Interval = { low: number; high: number };

/** A place on the screen, px from the corner of a box. */
type Place = { x: number; y: number };

/** The place of a plot on its canvas, px, and its scales. */
type Frame = { left: number; top: number; width: number; height: number; x: Interval; y: Interval };

/** A chart that is read item by item. */
interface Readable {
  /** The item at a place on the screen. */
  nearest(event: PointerEvent): number | null;
  /** The item that a key leads to; undefined for other keys. */
  moved(key: string, at: number | null): number | null | undefined;
  mark(item: number | null): void;
  words(item: number): string;
}

/** Acts of a drag. */
interface Drag {
  /** True where a drag or a click may begin. */
  press(place: Place, event: PointerEvent): boolean | void;
  /** On from where it was pressed. */
  drag(place: Place, from: Place, begins: boolean, event: PointerEvent): void;
  /** After a drag or a click. */
  release?(from: Place, dragged: boolean, event: PointerEvent): void;
  /** The browser has taken the pointer, as it does where a finger scrolls. */
  cancel?(dragged: boolean): void;
  /** Without a press. */
  hover?(place: Place, event: PointerEvent): void;
}

/** The axis of a plot of impacts. */
interface Axis {
  column: Lasting;
  /** About zero. */
  symmetric?: boolean;
  /** Least span, so that rounding does not look like motion. */
  span?: number;
  /** A low end that stays. */
  from?: number;
}

/** What a plot of impacts shows. */
interface Meaning {
  id: string;
  title: string;
  about: string | Node;
  x: Axis;
  y: Axis;
  /** Columns in the table of its numbers, after the bounce and its time. */
  listed: Column[];
  /** Told while there is nothing. */
  hint: string;
  /** Told when impacts have no such values. */
  lacking?: string;
  /** For those who do not see it. */
  spoken: string;
  /** Horizontal lines worth comparing with. */
  levels?(): { value: number; name: string }[];
  /** The release whose first impact is at a place in it. */
  start?: typeof import('../../web/physics/first-impact.js').angleStart;
}

/** A run to compare with. */
interface Reference {
  run: RunState;
  /** The first impact that is shown. */
  from?: number;
  symbol: '●' | '■' | '◆' | '▲';
  colour: Colour;
  label: string;
}

/** A release that is offered. */
interface Offered {
  /** The place that was clicked; null in another plot, which marks the first impact. */
  at: { x: number; y: number } | null;
  /** Null while it is awaited. */
  run: RunState | null;
}

// Body and table.

/** Of the centre of gravity, m, and the angle, rad. */
type Pose = { x: number; y: number; theta: number };

/** The flight that starts at `t`; its duration is 0 where there is none. */
type Arc = Pose & { t: number; x_dot: number; y_dot: number; theta_dot: number; duration: number };

/** The middle of the table’s face, m, and its tilt. */
type TablePose = { x: number; y: number; alpha: number };

/** The table as it meets the rod. */
interface Strike {
  t: number;
  /** Of the contact point. */
  x: number;
  /** Of it, not 0 where the table strikes early or late. */
  y: number;
  /** rad */
  alpha: number;
  /** Along the normal, m/s. */
  speed: number;
}

/** The world on its canvas at a moment. */
interface Stage {
  surface: Surface;
  /** Metres to px. */
  x(x: number): number;
  y(y: number): number;
  /** A metre in px. */
  metre: number;
  /** The lower end of the picture above the ruler, px. */
  floor: number;
  /** True where rulers, symbols and numbers of strikes are drawn. */
  measured: boolean;
}

/** The drawn things, for parts that go with them. */
interface Drawn {
  stage: Stage;
  scene: Scene;
  pose: Pose;
  table: TablePose;
  /** Half of the table’s width, m. */
  half: number;
  /** The marks of a strike are there. */
  struck: boolean;
}

// The run.

/** What is done to a run at an impact; `guide` has the parameters of a catch or a throw. */
interface Intervention {
  impact: number;
  set: Record<string, number | string | number[]>;
  kick: Record<string, number>;
  guide: Record<string, string>;
}

/** Hears the news of a run. */
interface Watcher {
  /** Phase, scene, speed or address. */
  changed?(): void;
  /** There are new impacts. */
  struck?(): void;
  /** Another time is shown. */
  moved?(): void;
  /** A new run: all that was drawn is void. */
  cleared?(): void;
  /** Seconds to the next try, while the phase says so. */
  lost?(seconds: number): void;
  refused?(problem: Problem): void;
  /** With one message. */
  problem?(refusal: Refusal): void;
}

/** A run beside the live one; where it is staged, its rod is drawn too. */
type Other = Reference & { staged: boolean };

/** The page at a moment. */
interface PageState {
  scene: Scene;
  releasedAs: Scene;
  chosen: Case | null;
  /** The query that replays its run. */
  run: string | null;
  /** The part of the address of the pinned runs. */
  pins: string;
}

// Panels.

/** A verdict and the scene it is of. */
type Judged = { answer: Stability; scene: URLSearchParams };

/** A panel that is loaded when it is drawn for the first time. */
interface Entry {
  /** Also the beginning of its parts of the address, and its name under `embed/`. */
  id: string;
  /** The page that it stands in: `./` is Play. */
  page: string;
  /** Its tab in Play. */
  tab?: string;
  title: string;
  about: string;
  /** It fills its place as it is, and is not opened large. */
  fills?: boolean;
  /** Class of its card. */
  kind?: string;
  /** Its style sheets, where they are not those of a study. */
  sheets?: string[];
  module: string;
  /** A component, by its name in the module; it takes the page. */
  component: string;
  /** Path of an answer that it takes as well. */
  asks?: string;
}

/** An answer that follows what is asked. */
interface Answer<A> {
  /** The newest; null before the first. */
  answer: A | null;
  /** The path that it answers. */
  of: string | null;
  /** It answers what is asked now. */
  current: boolean;
  /** The refusal of what is asked now. */
  problem: Problem | null;
  /** Words on a server that does not answer; '' for one that does. */
  lost: string;
}

/** Something to save: a panel or a chart. */
interface Saves {
  id: string;
  title: string;
  /** The call that gives its numbers, from where the page is; null where there are none yet. */
  path: string | null;
  /** Formats that the server has for them. */
  formats: string[];
  /** Where the page draws it. */
  view?: CanvasView;
}

/** A part of the page with a place of its own that takes its part of the address, or hears of the scene. */
interface Neighbour {
  sceneChanged?(): void;
  /** Its part of the address. */
  query?(): URLSearchParams;
  /** From that part; gives what was dropped of it, in words. */
  restore?(link: URLSearchParams): string[];
}

/** The tabs beside the scene. */
interface Panels {
  draw(): void;
  /** Opens a tab, or that of a panel. */
  show(id: string): void;
  join(id: string, neighbour: Neighbour): void;
  /** Shows what a link asks for: its tab, else that of the first panel with a part in it. */
  restore(link: URLSearchParams): void;
  /** Their part of the page’s address. */
  query(): URLSearchParams;
  sceneChanged(): void;
}

/** Parts of an address that are wrong, with words on each, and what of them is right. */
type Broken = [part: string, words: string, right?: string][];

/** A setting of a panel, by its name in the request. */
interface Setting {
  /** Its part of the address behind the panel’s, where that is not its name. */
  key?: string;
  label: unknown;
  /** A field without one may be left empty. */
  usual?: number | string;
  /** In which it is typed. */
  unit?: string;
  /** Typed units in one of the address. */
  scale?: number;
  /** With their words. */
  choices?: Record<string, string>;
  right?(value: number): boolean;
  /** It may be left empty though it has a usual value. */
  open?: boolean;
  disabled?: boolean;
  /** It must be, in words. */
  must?: string;
}

/** The page around a panel, as far as the panel knows it. */
interface PanelPage {
  fields: Field[];
  /** The scene; null while some of it is no value. */
  query: URLSearchParams | null;
  /** As far as it goes. */
  scene: Scene;
  /** Parts of the address that belong to panels. */
  link: URLSearchParams;
  /** Changes such parts; null takes one away. */
  part(changes: Record<string, string | null>): void;
  /** Takes broken parts away, and tells of them. */
  drop(id: string, broken: Broken): void;
  /** Shows another scene. */
  take(scene: Scene): void;
  /** Nobody is there to press a button. */
  unattended?: boolean;
  /** Another panel, with this as its part of the address. */
  open?(id: string, link: URLSearchParams): void;
  /** Releases the scene with these values in it. */
  launch?(values: Record<string, number>): void;
  /** Drops the scene with these values, at the first turn of a drag and at others. */
  dropWith?(values: Record<string, number>, first: boolean): void;
  /** The page of Play with its run, which the panel may act on. */
  play?: Page;
}

/** A field of a map with its ends. */
type Side = { field: Field; from: number; to: number };
type Sides = { x: Side; y: Side };

/** The sides of a map, and values by their names in the request. */
type MapSettings = Sides & { quantity: string; bounces: number; columns: number } & Record<string, any>;
