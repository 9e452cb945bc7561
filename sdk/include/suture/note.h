/* SPDX-License-Identifier: MIT
 *
 * suture/note.h - what a plugin file says about itself without being loaded.
 *
 * Loading a shared object runs code (constructors), so a file must be listed or
 * refused before. One ELF note in its section ".note.suture" carries what that
 * needs: the ABI, the lanes, the instruction set, the plugin's id and the ids
 * of its models. `readelf -n FILE` shows it under the owner "Suture".
 *
 * A plugin written in C places this line once, in one source file:
 *
 *   SUTURE_NOTE("my-plugin", "model-a model-b")
 *
 * The C++ layer places it for you. The instruction set is that of the compiler
 * flags of the file in which the line stands: one source built three times (see
 * suture_add_plugin) gives three files with three notes.
 *
 * Growth: the descriptor is append-only, a reader tests `size` first. The note
 * is data of the file, never read by address: the plugin needs no symbol for it.
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

/* What the flags of this compilation admit, in the names of files:
 * NAME.avx512.so, NAME.avx2.so, and NAME.so for the base line of the
 * architecture. */
#if defined(__AVX512F__)
#define SUTURE_NOTE_ISA "avx512"
#elif defined(__AVX2__)
#define SUTURE_NOTE_ISA "avx2"
#else
#define SUTURE_NOTE_ISA "base"
#endif

/* The descriptor. Strings are zero-terminated UTF-8, the rest of each is 0. */
typedef struct suture_note_desc {
  uint32_t size;                         /* of this struct, as compiled into the plugin */
  uint32_t magic;                        /* SUTURE_MAGIC */
  uint32_t abi_major;                    /* SUTURE_ABI_MAJOR */
  uint32_t abi_minor;                    /* SUTURE_ABI_MINOR */
  uint32_t lanes;                        /* SUTURE_LANES */
  uint32_t reserved;                     /* 0 */
  char isa[24];                          /* SUTURE_NOTE_ISA */
  char plugin[SUTURE_NOTE_PLUGIN_CHARS]; /* suture_plugin.id */
  char models[SUTURE_NOTE_MODELS_CHARS]; /* ids, one space between two */
} suture_note_desc;

/* The whole note as ELF wants it: header, owner padded to 4, descriptor. */
typedef struct suture_note {
  uint32_t owner_size; /* strlen + 1 */
  uint32_t desc_size;
  uint32_t type;
  char owner[8];
  suture_note_desc desc;
} suture_note;

/* Storage of a suture_note: kept though nobody refers to it, aligned as notes
 * are (an aggregate of this size would get 32). */
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

/* Both arguments are string literals; ids of models are separated by one space.
 * Too long an id is a compile error. */
#define SUTURE_NOTE(plugin_id, model_ids)                                  \
  SUTURE_NOTE_ASSERT(sizeof(plugin_id) <= SUTURE_NOTE_PLUGIN_CHARS,        \
                     "plugin id longer than 63 characters");               \
  SUTURE_NOTE_ASSERT(sizeof(model_ids) <= SUTURE_NOTE_MODELS_CHARS,        \
                     "ids of models longer than 911 characters together"); \
  SUTURE_NOTE_STORAGE suture_note suture_note_of_this_plugin =             \
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

/* The same note from ids that are constants of types, for the C++ layer:
 *   SUTURE_NOTE_STORAGE constexpr suture_note n = suture::make_note("p", A::id, B::id);
 * An id that is too long is a compile error (a throw in a constant). */
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
      if (at + 2 >= SUTURE_NOTE_MODELS_CHARS) throw "ids of models too long together";
      note.desc.models[at++] = *id;
    }
  }
  return note;
}

} /* namespace suture */
#endif
#endif
#endif
