// Starts the replay of the recording that the page carries, or the page that makes one as it is asked to.

import { attend } from "./live.js";
import { Recording } from "./recording.js";
import { Replay } from "./replay.js";

const carried = document.getElementById("recording"), replay = new Replay();
if (carried) {
  replay.show(new Recording(JSON.parse(carried.textContent)));
  replay.begin();
}
if (document.getElementById("settings")) attend(replay);
