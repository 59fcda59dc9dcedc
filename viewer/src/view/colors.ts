/** Colors of the view. Those of the two parts differ for people with any kind of color blindness (Okabe and Ito). */
import { ColorManagement } from "three";

// Colors are drawn as they are. Without a graphics card, converting each pixel takes longer than lighting it.
ColorManagement.enabled = false;

export const FIRST = 0x2f7fc1;
export const SECOND = 0xe69f00;
/** What both parts share: curves, the point, and the common area of a section. */
export const SHARED = 0xc2185b;

export interface Theme {
  readonly background: number;
  /** Parts around the selected ones. */
  readonly ghost: number;
  readonly ghostOpacity: number;
  readonly solid: number;
  readonly edge: number;
  readonly shared: number;
  /** Intersecting faces. */
  readonly hit: number;
  /** Boxes of a hierarchy. */
  readonly box: number;
}

export const LIGHT: Theme = {
  background: 0xf4f5f7,
  ghost: 0x4a5568,
  ghostOpacity: 0.34,
  solid: 0xd5d9e0,
  edge: 0x1b2330,
  shared: SHARED,
  hit: 0xe0729b,
  box: 0x1f5fa8,
};

export const DARK: Theme = {
  background: 0x14181f,
  ghost: 0xaebbd0,
  ghostOpacity: 0.3,
  solid: 0x8d98a8,
  edge: 0x05070a,
  shared: 0xff5c9a,
  hit: 0xc9447a,
  box: 0x7db7f2,
};
