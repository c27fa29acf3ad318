// Starts the replay of the recording in the page, or the live page, whose recordings come from its server.

import { startLivePage } from "./live.js";
import { Recording } from "./recording.js";
import { Replay } from "./replay.js";

const carried = document.getElementById("recording"), replay = new Replay();
if (carried) {
  replay.show(new Recording(JSON.parse(carried.textContent)));
  replay.begin();
}
if (document.getElementById("settings")) startLivePage(replay);
