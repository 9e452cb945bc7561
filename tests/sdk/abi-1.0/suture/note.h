/* SPDX-License-Identifier: MIT
 *
 * suture/note.h - what a plugin file says about itself without being loaded.
 *
 * Loading a shared object runs code (constructors), so the host must be able to
 * list or refuse a file without loading it. One ELF note in the section
 * ".note.suture" holds what this requires: the ABI, the lanes, the instruction
 * set, the plugin's id and the ids of its models. `readelf -n FILE` shows it under
 * the owner "Suture".
 *
 * A plugin written in C places this line once, in one source file:
 *
 *   SUTURE_NOTE("my-plugin", "model-a model-b")
 *
 * The C++ layer places it for you. The note names the instruction set for which
 * the file with this line is compiled: one source built three times (see
 * suture_add_plugin) gives three files with three notes.
 *
 * Growth: the descriptor is append-only; a reader tests `size` first. The note is
 * read from the file, never through an address: the plugin needs no symbol for it.
 */
#ifndef SUTURE_NOTE_H
#define SUTURE_NOTE_H

#include "suture/plugin.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SUTURE_NOTE_TYPE 1u /* n_type of the note; its owner is "Suture" */
#define SUTURE_NOTE_OWNER "Suture"
#define SUTURE_NOTE_PLUGIN_CHARS 64  /* with the final zero */
#define SUTURE_NOTE_MODELS_CHARS 912 /* with the final zero */

/* The instruction set that the flags of this compilation allow, as in the names of
 * files: NAME.avx512.so, NAME.avx2.so, and NAME.so for the baseline of the
 * architecture. */
#if defined(__AVX512F__)
#define SUTURE_NOTE_ISA "avx512"
#elif defined(__AVX2__)
#define SUTURE_NOTE_ISA "avx2"
#else
#define SUTURE_NOTE_ISA "base"
#endif

/* The descriptor. Strings are zero-terminated UTF-8; their remaining bytes are 0. */
typedef struct suture_note_desc {
  uint32_t size;                         /* of this struct, as compiled into the plugin */
  uint32_t magic;                        /* SUTURE_MAGIC */
  uint32_t abi_major;                    /* SUTURE_ABI_MAJOR */
  uint32_t abi_minor;                    /* SUTURE_ABI_MINOR */
  uint32_t lanes;                        /* SUTURE_LANES */
  uint32_t reserved;                     /* 0 */
  char isa[24];                          /* SUTURE_NOTE_ISA */
  char plugin[SUTURE_NOTE_PLUGIN_CHARS]; /* suture_plugin.id */
  char models[SUTURE_NOTE_MODELS_CHARS]; /* ids, separated by one space */
} suture_note_desc;

/* The whole note as ELF requires it: header, owner padded to 4 bytes, descriptor. */
typedef struct suture_note {
  uint32_t owner_size; /* strlen + 1 */
  uint32_t desc_size;
  uint32_t type;
  char owner[8];
  suture_note_desc desc;
} suture_note;

/* Storage of a suture_note: kept although nothing refers to it, and aligned as
 * notes are (compilers align an aggregate of this size to 32 bytes). */
#define SUTURE_NOTE_STORAGE __attribute__((section(".note.suture"), used, aligned(4))) static const

#define SUTURE_NOTE_INITIALIZER(plugin_id, model_ids)                                              \
  {                                                                                                \
    sizeof(SUTURE_NOTE_OWNER), sizeof(suture_note_desc), SUTURE_NOTE_TYPE, SUTURE_NOTE_OWNER, {    \
      sizeof(suture_note_desc), SUTURE_MAGIC, SUTURE_ABI_MAJOR, SUTURE_ABI_MINOR, SUTURE_LANES, 0, \
          SUTURE_NOTE_ISA, plugin_id, model_ids                                                    \
    }                                                                                              \
  }

#ifdef __cplusplus
#define SUTURE_NOTE_ASSERT(condition, text) static_assert(condition, text)
#else
#define SUTURE_NOTE_ASSERT(condition, text) _Static_assert(condition, text)
#endif

/* Both arguments are string literals; the ids of the models are separated by one
 * space. An id that is too long is a compile-time error. */
#define SUTURE_NOTE(plugin_id, model_ids)                              \
  SUTURE_NOTE_ASSERT(sizeof(plugin_id) <= SUTURE_NOTE_PLUGIN_CHARS,    \
                     "plugin id longer than 63 characters");           \
  SUTURE_NOTE_ASSERT(sizeof(model_ids) <= SUTURE_NOTE_MODELS_CHARS,    \
                     "model ids longer than 911 characters in total"); \
  SUTURE_NOTE_STORAGE suture_note suture_note_of_this_plugin =         \
      SUTURE_NOTE_INITIALIZER(plugin_id, model_ids);

SUTURE_NOTE_ASSERT(sizeof(suture_note_desc) == 1024, "layout of the note");
SUTURE_NOTE_ASSERT(offsetof(suture_note_desc, isa) == 24, "layout of the note");
SUTURE_NOTE_ASSERT(offsetof(suture_note_desc, plugin) == 48, "layout of the note");
SUTURE_NOTE_ASSERT(offsetof(suture_note_desc, models) == 112, "layout of the note");
SUTURE_NOTE_ASSERT(offsetof(suture_note, desc) == 20, "layout of the note");
SUTURE_NOTE_ASSERT(sizeof(suture_note) == 1044, "layout of the note");

#ifdef __cplusplus
} /* extern "C" */

#if __cplusplus >= 201703L
namespace suture {

/* The same note for the C++ layer, from ids that are static members of types:
 *   SUTURE_NOTE_STORAGE constexpr suture_note n = suture::make_note("p", A::id, B::id);
 * An id that is too long is a compile-time error (a throw in a constant expression). */
template <class... Ids>
constexpr suture_note make_note(const char* plugin, Ids... models) {
  suture_note note = SUTURE_NOTE_INITIALIZER("", "");
  for (int i = 0; (note.desc.plugin[i] = plugin[i]) != 0; ++i)
    if (i + 2 > SUTURE_NOTE_PLUGIN_CHARS) throw "plugin id longer than 63 characters";
  int at = 0;
  const char* const ids[] = {models...};
  for (const char* id : ids) {
    if (at > 0) note.desc.models[at++] = ' ';
    for (; *id != 0; ++id) {
      if (at + 2 >= SUTURE_NOTE_MODELS_CHARS) throw "model ids longer than 911 characters in total";
      note.desc.models[at++] = *id;
    }
  }
  return note;
}

} /* namespace suture */
#endif
#endif
#endif
