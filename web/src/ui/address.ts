/** The page's address holds what is not in the machine file: the example, the limit, the pose. */

export interface Place {
  /** Name of the example. */
  example: string;
  /** Limit of the headline, um; empty without. */
  limit: string;
  /** `volume` where figures are over the volume in spite of a part. */
  over: string;
  /** Name of the tool; empty for the first of the file. */
  tool: string;
  /** Pose, `X=250,C=90`. */
  pose: string;
  /** Name of the open tab; empty for the first. */
  view: string;
  /** Path of the file of tool poses. */
  work: string;
  /** Name of the control. */
  target: string;
  /** Goal of the value that 95 % of machines keep, um. */
  goal: string;
  /** Field around the pose: `all`, or the axis across which a slice lies. */
  field: string;
  /** Axis of the curve. */
  along: string;
  /** The pane of the editor: `folded`, `wrapped`, its width in pixels. */
  pane: string;
  /** Picture beside the machine. */
  beside: string;
  /** Not empty where lever arms have their lengths. */
  arms: string;
  /** Units of the reader, `uin-arcsec`; empty for those of the file. */
  units: string;
}

export function place(): Place {
  const found = new URLSearchParams(location.hash.slice(1));
  const of = (name: string) => found.get(name) ?? "";
  return {
    example: of("example"),
    limit: of("limit"),
    over: of("over"),
    tool: of("tool"),
    pose: of("pose"),
    view: of("view"),
    work: of("work"),
    target: of("target"),
    field: of("field"),
    along: of("along"),
    beside: of("beside"),
    pane: of("pane"),
    goal: of("goal"),
    units: of("units"),
    arms: of("arms"),
  };
}

/** Changes a part of the address, without an entry in the history of the browser. */
export function move(change: Partial<Place>): void {
  const next = new URLSearchParams();
  for (const [name, value] of Object.entries({ ...place(), ...change })) if (value) next.set(name, value);
  history.replaceState(null, "", `#${next}`);
}
