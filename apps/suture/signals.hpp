// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

class OutputFolder;

/// Writing to a closed pipe, or beyond the limit on the size of files, is an error of that write
/// and not the end of the program.
void report_failed_writes();

/// SIGINT, SIGTERM and SIGHUP from here on: at once, with a message, while a scene is built, as
/// nothing is written then; an orderly end of a run once it has started. The second signal of a
/// kind kills. SIGHUP stays ignored under nohup.
void catch_signals();
/// The folder to leave as it was found if a signal comes while the scene is built.
void has_opened(const OutputFolder& folder);
/// The scene is built: signals wait for the step to end.
void has_started();
/// The signal that asks the run to end; 0 if there is none.
int caught_signal();

}  // namespace suture
