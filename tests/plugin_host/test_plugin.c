/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * A plugin with one model that does nothing, and one defect chosen by a macro.
 * TEST_ID is the id of the plugin and of its model. */
#include "suture/note.h"

#if defined(TEST_OTHER_MAJOR)
#undef SUTURE_ABI_MAJOR
#define SUTURE_ABI_MAJOR 7u
#elif defined(TEST_NEWER_MINOR)
#undef SUTURE_ABI_MINOR
#define SUTURE_ABI_MINOR 9u
#elif defined(TEST_OTHER_LANES)
#undef SUTURE_LANES
#define SUTURE_LANES 4u
#endif

#if defined(TEST_OTHER_IDS)
SUTURE_NOTE(TEST_ID, TEST_ID " some-other-model")
#elif !defined(TEST_NO_NOTE)
SUTURE_NOTE(TEST_ID, TEST_ID)
#endif

#ifdef TEST_UNDEFINED_SYMBOL
extern double nobody_defines_this(double);
#endif

/* Refused files must not run: a constructor reports to the test if one did. */
#include <stdlib.h>
__attribute__((constructor)) static void loaded(void) { setenv("TEST_PLUGIN_LOADED", TEST_ID, 1); }

static suture_status force(const suture_context* context, const suture_batch* batch) {
  (void)context;
  for (uint32_t i = 0; i < batch->nodes * 3 * batch->lanes; ++i) batch->force[i] = 0;
#ifdef TEST_UNDEFINED_SYMBOL
  batch->force[0] = nobody_defines_this(0);
#endif
  return SUTURE_OK;
}

static const suture_functor functors[] = {{
    .size = sizeof(suture_functor),
    .dimension = 3,
    .cell_type = SUTURE_HEXAHEDRON,
    .lanes = SUTURE_LANES,
    .name = "nothing",
    .doc = "No force.",
    .force = force,
}};

#define MODEL                                                                           \
  {                                                                                     \
    .size = sizeof(suture_model), .id = TEST_ID, .doc = "Nothing.", .formula = "f = 0", \
    .citation = "none", .functor_count = 1, .functors = functors                        \
  }

#ifdef TEST_TWO_MODELS
static const suture_model models[] = {MODEL, MODEL};
#else
static const suture_model models[] = {MODEL};
#endif

#ifdef TEST_MISSING_EXTENSION
static const char* const required[] = {"suture.energi/1"};
#else
static const char* const required[] = {SUTURE_ENERGY_1};
#endif

static const suture_plugin plugin = {
    .size = sizeof(suture_plugin),
    .magic = SUTURE_MAGIC,
    .abi_major = SUTURE_ABI_MAJOR,
    .abi_minor = SUTURE_ABI_MINOR,
    .lanes = SUTURE_LANES,
    .model_count = sizeof(models) / sizeof(models[0]),
    .id = TEST_ID,
    .version = "1.0",
    .license = "MIT",
    .description = "For tests of the host.",
#ifndef TEST_NULL_TABLE
    .models = models,
#endif
    .required_extension_count = 1,
    .required_extensions = required,
};

#ifdef TEST_NO_SYMBOL
const suture_plugin* another_name(void);
const suture_plugin* another_name(void) { return &plugin; }
#else
const suture_plugin* suture_plugin_v1(void);
const suture_plugin* suture_plugin_v1(void) {
#ifdef TEST_RETURNS_NULL
  (void)plugin;
  return NULL;
#else
  return &plugin;
#endif
}
#endif
