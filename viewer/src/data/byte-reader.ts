/** Reads numbers as `crates/impinge-report/src/html/integers.rs` writes them. */
export class ByteReader {
  private at = 0;
  private readonly view: DataView;

  constructor(private readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  /** Reads an integer of any size: 7 bits a byte, the lowest first. */
  integer(): number {
    let value = 0;
    let weight = 1;
    for (;;) {
      const byte = this.bytes[this.at++];
      value += (byte & 0x7f) * weight;
      if (byte < 0x80) return value;
      weight *= 128;
    }
  }

  /** Reads a number of 8 bytes. */
  number(): number {
    const value = this.view.getFloat64(this.at, true);
    this.at += 8;
    return value;
  }

  /** Reads a number of 4 bytes. */
  rounded(): number {
    const value = this.view.getFloat32(this.at, true);
    this.at += 4;
    return value;
  }

  numbers(count: number): number[] {
    return Array.from({ length: count }, () => this.number());
  }

  /** Reads points in steps of a box: all x, then all y, then all z, each as the difference from the one before. */
  points(count: number): Uint16Array {
    const points = new Uint16Array(3 * count);
    for (let axis = 0; axis < 3; axis++) {
      let value = 0;
      for (let at = axis; at < points.length; at += 3) {
        const code = this.integer();
        value += code % 2 === 0 ? code / 2 : -(code + 1) / 2;
        points[at] = value;
      }
    }
    return points;
  }

  /** Reads corners of faces: each is its distance below the next unused point. */
  corners(count: number): Uint32Array {
    const corners = new Uint32Array(count);
    let unused = 0;
    for (let at = 0; at < count; at++) {
      const corner = unused - this.integer();
      corners[at] = corner;
      if (corner === unused) unused++;
    }
    return corners;
  }
}
