/** Saves a BCF file of the report, with the statuses of the page and pictures of the topics. */
import { bcfFile } from "../bcf/archive";
import type { Shot } from "../bcf/viewpoint";
import { save } from "../data/downloads";
import type { ClashModel } from "../data/model";
import type { Bcf } from "../data/report";
import { Snapshots } from "../view/snapshots";

/** Maximum number of topics with a picture: the first. More take a minute without a graphics card. */
export const MAX_PICTURES = 100;

/** Time after which the page answers again while cameras are placed, in milliseconds. */
const PAUSE = 50;

/** Saves the file, and tells `progress` how many topics are done. */
export async function saveBcf(model: ClashModel, bcf: Bcf, progress: (done: number) => void): Promise<void> {
  const snapshots = new Snapshots(model, bcf.size, bcf.field_of_view);
  try {
    const shots: (Shot | undefined)[] = [];
    let paused = 0;
    for (const topic of bcf.topics) {
      shots.push(await snapshots.shoot(model.findings[topic.findings[0]], shots.length < MAX_PICTURES));
      if (performance.now() - paused > PAUSE) {
        progress(shots.length);
        await new Promise((resume) => setTimeout(resume));
        paused = performance.now();
      }
    }
    save("clashes.bcfzip", bcfFile(model, bcf, shots, new Date()), "application/zip");
  } finally {
    snapshots.dispose();
  }
}
