// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

class OutputFolder;

/// Makes writing to a closed pipe, or beyond the limit on the size of files, an error of that write
/// instead of the end of the program.
void report_failed_writes();

/// Handles SIGINT, SIGTERM and SIGHUP from now on. While a scene is being built, the program ends
/// at once with a message, because nothing is written yet; a run that has started ends in an
/// orderly way. The second signal of a kind kills the process. SIGHUP stays ignored under nohup.
void catch_signals();
/// The folder to restore to its original state if a signal arrives while the scene is built.
void has_opened(const OutputFolder& folder);
/// Call it when the scene is built: from then on signals take effect at the end of a step.
void has_started();
/// The signal that requested the end of the run; 0 if there is none.
int caught_signal();

}  // namespace suture
