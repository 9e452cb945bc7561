/* SPDX-License-Identifier: GPL-3.0-or-later
 * The C headers compile alone as C11; a plugin can be written in C. */
#include "suture/note.h"
#include "suture/plugin.h"

SUTURE_NOTE("c11", "c11")

static const suture_plugin plugin = {sizeof(suture_plugin),
                                     SUTURE_MAGIC,
                                     SUTURE_ABI_MAJOR,
                                     SUTURE_ABI_MINOR,
                                     SUTURE_LANES,
                                     0,
                                     "c11",
                                     "1.0",
                                     "MIT",
                                     "from C",
                                     NULL,
                                     0,
                                     0,
                                     NULL};

const suture_plugin* c11_plugin(void) { return &plugin; }
