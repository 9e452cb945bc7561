/* SPDX-License-Identifier: MIT
 *
 * suture/plugin.h - the binary contract between Suture and a physics model.
 *
 * A plugin is a shared library that exports one function, suture_plugin_v1(),
 * and carries one ELF note (suture/note.h) with which the host can list or
 * refuse the file before any of its code runs. Everything that crosses the
 * boundary is declared here: fixed-width integers, doubles and pointers, in
 * structs whose first member is their size. No C++ type, no exception and no
 * allocation crosses it.
 *
 * Most authors never include this file: suture/model.hpp builds these tables
 * from a C++ struct of 20 to 60 lines. Read this one to learn what is promised.
 *
 * Growth. Structs are append-only within an ABI major version, and a member that a
 * later minor version adds has no effect while it is 0. The host copies a plugin's
 * tables into its own structs and sets the members that the plugin does not have to
 * 0, so a plugin built for an older minor version keeps working; elements of an
 * array are `size` bytes apart. A plugin tests `size` before it reads a member that
 * a later minor version added to a struct of the host (SUTURE_HAS). Published
 * members and extensions never change their meaning. Unused bits are zero.
 *
 * Units are SI. Coordinates are right-handed. A hexahedron's nodes are X0..X7
 * with X_i = (i&1, (i>>1)&1, (i>>2)&1): the x index runs fastest.
 *
 * Life-cycle tags used below:
 *   [main]    called on the thread that runs the simulation, never concurrently
 *   [worker]  called on any worker thread, concurrently with itself for
 *             different batches; must not write anything but its outputs
 */
#ifndef SUTURE_PLUGIN_H
#define SUTURE_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SUTURE_ABI_MAJOR 1u      /* must be equal in plugin and host */
#define SUTURE_ABI_MINOR 0u      /* plugin's minor must not exceed the host's */
#define SUTURE_LANES 8u          /* cells in a batch */
#define SUTURE_ALIGNMENT 64u     /* of every array in a batch, in bytes */
#define SUTURE_MAGIC 0x31565453u /* "STV1" as a little-endian word */

/* True if the struct at `pointer` was compiled with `member`. */
#define SUTURE_HAS(pointer, member) \
  ((pointer)->size >= offsetof(__typeof__(*(pointer)), member) + sizeof((pointer)->member))

/* ---------------------------------------------------------------- status -- */

/* Returned by every function of a plugin that can fail.
 * SUTURE_OK: success. SUTURE_RETRY: the step may succeed if it is repeated with a
 * smaller dt (see suture_error.step_factor). SUTURE_STOP: the run must stop, because
 * the law is not defined for this state. SUTURE_FAULT: the run must stop, because the
 * plugin has a bug, such as an exception that it did not catch; suture_error.text
 * describes it. Any other value is a fault, too. */
typedef int32_t suture_status;
#define SUTURE_OK 0
#define SUTURE_RETRY 1
#define SUTURE_STOP (-1)
#define SUTURE_FAULT (-2)

/* One record per worker, owned by the host, reset before each call. If several calls
 * of a step fail, the same record is reported for any number of threads: faults come
 * before stops, stops before retries, then the first functor, then the lowest cell. */
typedef struct suture_error {
  uint32_t size;
  int32_t code;       /* the plugin's own number, shown to the user */
  uint32_t cell;      /* id from suture_batch.cell_ids, or UINT32_MAX */
  uint32_t reserved;  /* 0 */
  double step_factor; /* with SUTURE_RETRY: proposed dt / current dt; 0: none proposed */
  char text[512];     /* zero-terminated UTF-8; what happened and what to do */
} suture_error;

/* ---------------------------------------------------------------- tables -- */

enum suture_parameter_type {
  SUTURE_NUMBER = 0,   /* any double in [minimum, maximum] */
  SUTURE_INTEGER = 1,  /* a double with an integral value */
  SUTURE_BOOLEAN = 2,  /* 0 or 1 */
  SUTURE_CHOICE = 3,   /* index into choices */
  SUTURE_DIRECTION = 4 /* a unit vector, normalised by the host; always SUTURE_PER_ELEMENT */
};

enum suture_parameter_flag {
  SUTURE_REQUIRED = 1u << 0,         /* no default: the scene must set it */
  SUTURE_MINIMUM_EXCLUDED = 1u << 1, /* value > minimum, not >= */
  SUTURE_MAXIMUM_EXCLUDED = 1u << 2,
  /* Numbers and directions only: the value may differ from element to element. The model
   * has an attribute of dimension 3 with the same name, 1 component (a direction: 3) and
   * the flag SUTURE_PARAMETER, whose column holds the values. Where they differ, and for
   * directions, suture_context.parameters holds NaN. */
  SUTURE_PER_ELEMENT = 1u << 3
};

/* One parameter of a model, as `suture describe` prints it. The host reads the
 * scene, checks types and ranges, and passes plain doubles, in this order. */
typedef struct suture_parameter {
  uint32_t size;
  uint32_t type;  /* suture_parameter_type */
  uint32_t flags; /* suture_parameter_flag */
  uint32_t choice_count;
  const char* name; /* key in the scene: "E" */
  const char* unit; /* "Pa"; "1" if dimensionless */
  const char* doc;  /* one sentence */
  double default_value;
  double minimum; /* -INFINITY if unbounded */
  double maximum;
  const char* const* choices; /* choice_count strings, or NULL */
} suture_parameter;

/* What happens to the value of an attribute when its cell splits, merges or
 * vanishes. Applied by the host, in one place, after every operation.
 *             split                        merge                    removal
 * COPY        both parts keep the value    mass-weighted mean       dropped
 * ZERO        old part keeps it, new is 0  sum                      dropped
 * SHARE       divided in proportion to     sum                      dropped
 *             the incident volumes
 * FROM_VOLUMES each part summed again over summed again             dropped
 *             its incident 3-cells by the
 *             contribution function       */
enum suture_policy { SUTURE_COPY = 0, SUTURE_ZERO = 1, SUTURE_SHARE = 2, SUTURE_FROM_VOLUMES = 3 };

enum suture_attribute_flag {
  SUTURE_OUTPUT = 1u << 0,          /* a scene may request it as a field of frames */
  SUTURE_TRIAL = 1u << 1,           /* state: a pair (accepted, trial). Functors read
                                       the first and write the second; the two are
                                       swapped when the step is accepted, and the
                                       second is discarded when it is rejected. Part
                                       of every checkpoint */
  SUTURE_SHARED_MASS = 1u << 2,     /* not a separate column: the contributions are
                                       summed into the kernel's vertex mass */
  SUTURE_PARAMETER = 1u << 3,       /* the values of the parameter of this name, which is
                                       SUTURE_PER_ELEMENT; policy COPY */
  SUTURE_FROM_PARAMETERS = 1u << 4, /* dimension 3: the contribution depends on parameters
                                       only, and is computed once if these are uniform */
  SUTURE_INTERNAL = 1u << 5,        /* of no interest to users: not listed, and a scene
                                       cannot set it */
  /* Hosts older than the next two refuse the model by name. */
  SUTURE_FIELD = 1u << 6,      /* an unknown on vertices, such as a temperature, which the host
                                  integrates: dimension 0, 1 to 3 components, policy COPY. One
                                  column for all models of a body with a field of this name; where
                                  vertices merge, the mean weighs by capacity */
  SUTURE_CAPACITY = 1u << 7,   /* of the field that is declared last before it: what a vertex
                                 takes up per unit of the field, such as J/K; the contributions
                                 of all models are summed. Dimension 0, 1 component,
                                 FROM_VOLUMES, not negative */
  SUTURE_RISING = 1u << 8,     /* with SUTURE_FIELD: the value of a vertex never falls in a step */
  SUTURE_RELAXATION = 1u << 9, /* of the field that is declared last before it, otherwise as
                               SUTURE_CAPACITY: about what the deformation takes up per unit of
                               the field. Implicit steps solve for motion and field in turns, and
                               each turn adds this times the change since the turn before, per
                               second */
  SUTURE_FIELD_RATE = 1u << 10 /* of the field that is declared last before it: its change over
                               the implicit step in progress, per second. Written by the host;
                               dimension 0, as many components, policy COPY. Only the functors that
                               change the field read it, and then explicit steps are refused */
};

/* The types of cells for which functors and contributions are written. */
enum suture_cell_type {
  SUTURE_VERTEX = 1,        /* dimension 0, 1 node */
  SUTURE_EDGE = 2,          /* dimension 1, 2 nodes */
  SUTURE_QUADRILATERAL = 3, /* dimension 2, 4 nodes, normal outward from side 0 */
  SUTURE_HEXAHEDRON = 4     /* dimension 3, 8 nodes X0..X7 */
};

struct suture_context;
struct suture_batch;

/* The values that each 3-cell of the batch contributes to its incident cells of the
 * attribute's dimension: out[(k*components + c)*lanes + lane]. In a hexahedron k
 * runs over the 8 vertices X0..X7 (dimension 0), the 12 edges (dimension 1, order of
 * suture_hexahedron_edges), the 6 faces (dimension 2, order of
 * suture_hexahedron_faces) or the cell itself (dimension 3, k = 0).
 * The batch holds only rest positions, cell ids and, in cell_columns, the attributes
 * with SUTURE_PARAMETER in the order of the model's list (NULL if there are none).
 * [worker] at the start and after each operation, for the cells that it touched. */
typedef suture_status (*suture_contribution_fn)(const struct suture_context* context,
                                                const struct suture_batch* batch, double* out);

/* What the 3-cells of one type contribute to an attribute. */
typedef struct suture_contribution {
  uint32_t size;
  uint32_t cell_type; /* suture_cell_type, of dimension 3 */
  suture_contribution_fn function;
} suture_contribution;

/* One attribute: a column of doubles on the cells of one dimension, owned by
 * the host, one per instance of the model. */
typedef struct suture_attribute {
  uint32_t size;
  uint32_t dimension;  /* 0 vertex, 1 edge, 2 face, 3 volume */
  uint32_t components; /* 1..9 */
  uint32_t policy;     /* suture_policy */
  uint32_t flags;      /* suture_attribute_flag */
  uint32_t contribution_count;
  const char* name;
  const char* unit;
  const char* doc;
  double initial; /* value of every component unless contributions compute it */
  /* with FROM_VOLUMES: one for each type of 3-cell for which the model is written;
   * otherwise NULL */
  const suture_contribution* contributions;
  /* of a field (SUTURE_FIELD): the values that a scene may give; both 0: any */
  double minimum, maximum;
} suture_attribute;

/* Vertex pairs of the 12 edges of a hexahedron: 0..3 along x, 4..7 along y,
 * 8..11 along z; within a direction the indices of the other two axes count as
 * binary digits, the lower axis as the lower digit. */
static const uint8_t suture_hexahedron_edges[12][2] = {
    {0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

/* Vertices of the 6 faces, in the order of dart[6][4]: x=0, y=0, x=1, y=1,
 * z=0, z=1, each counter-clockwise as seen from inside the element (by the
 * right-hand rule its normal points inward). */
static const uint8_t suture_hexahedron_faces[6][4] = {{2, 6, 4, 0}, {0, 4, 5, 1}, {1, 5, 7, 3},
                                                      {3, 7, 6, 2}, {2, 0, 1, 3}, {6, 7, 5, 4}};

/* ---------------------------------------------------------------- batches -- */

/* SUTURE_LANES cells of one functor, gathered by the host; the lane runs fastest:
 *   value(node, component, lane) = p[(node*components + component)*lanes + lane]
 * Every array is aligned to SUTURE_ALIGNMENT and holds finite numbers in all
 * lanes: lanes >= valid repeat the last valid cell, so no mask is needed.
 * rest, position and velocity are never NULL: they hold zeros if the functor did
 * not declare them or cleared them in enabled(). Lists of columns are NULL if no
 * column is declared. The host owns everything; no pointer is valid after the
 * call. */
typedef struct suture_batch {
  uint32_t size;
  uint32_t lanes;         /* SUTURE_LANES */
  uint32_t valid;         /* 1..lanes */
  uint32_t nodes;         /* per cell: 8 hexahedron, 4 face, 2 edge, 1 vertex */
  double time;            /* s, of the positions */
  double dt;              /* s, of the step in progress; 0 outside a step */
  const double* rest;     /* nodes x 3 x lanes, m */
  const double* position; /* nodes x 3 x lanes, m */
  const double* velocity; /* nodes x 3 x lanes, m/s */
  /* one pointer per declared column, in declared order */
  const double* const* cell_columns;   /* components x lanes each */
  const double* const* vertex_columns; /* nodes x components x lanes each */
  const uint32_t* cell_ids;            /* lanes: ids as users see them, for messages */
  double* force;                /* out: nodes x 3 x lanes, N; the host adds it to the nodes */
  double* const* trial_columns; /* out: trial copies of cell_columns, or NULL
                                   where the column has none */
} suture_batch;

enum suture_severity { SUTURE_NOTE = 0, SUTURE_WARNING = 1, SUTURE_ERROR = 2 };

/* Services of the host. */
typedef struct suture_host {
  uint32_t size;
  uint32_t abi_minor; /* of the host */
  /* Reports a finding about one cell (or, with cell = UINT32_MAX, about the
   * instance). The user sees it once per severity and `key`, with the number of
   * cells and the first of them; after an ERROR the scene is refused. `key` is a
   * short, stable word ("negative-stiffness"), `text` one sentence that includes
   * the remedy. Allowed in prepare, contributions with SUTURE_FROM_PARAMETERS and
   * suture_inspect_1 only. Any thread. */
  void (*report)(const struct suture_context* context, int32_t severity, uint32_t cell,
                 const char* key, const char* text);
  /* True if the host supports the extension. Any thread. */
  int32_t (*has_extension)(const char* id);
} suture_host;

/* What a functor receives besides its batch. One per instance and worker. */
typedef struct suture_context {
  uint32_t size;
  uint32_t parameter_count;
  const double* parameters; /* in declared order; NaN: see SUTURE_PER_ELEMENT */
  const void* instance;     /* what prepare() stored, or NULL */
  const suture_host* host;
  suture_error* error; /* fill before returning a status != 0 */
  void* host_data;     /* for the host only */
} suture_context;

/* --------------------------------------------------------------- functors -- */

enum suture_read { /* what the host gathers for a functor */
                   SUTURE_READ_REST = 1u << 0,
                   SUTURE_READ_POSITION = 1u << 1,
                   SUTURE_READ_VELOCITY = 1u << 2
};

/* The rest shapes of 3-cells for which a functor is written. Elements whose rest
 * shape is a parallelepiped (the edge vectors of each direction are equal to within
 * 1e-12 of the element's size) are SUTURE_PARALLELEPIPED, all others
 * SUTURE_GENERAL. A cell is visited by every functor whose shape includes it. */
enum suture_shape { SUTURE_ANY_SHAPE = 0, SUTURE_PARALLELEPIPED = 1, SUTURE_GENERAL = 2 };

/* Which faces a functor on 2-cells visits. */
enum suture_faces { SUTURE_ALL_FACES = 0, SUTURE_BOUNDARY_FACES = 1, SUTURE_INTERIOR_FACES = 2 };

/* Computes the forces of one batch. [worker] once per step and batch. The result
 * must depend on the declared inputs only, every lane of batch->force (and of the
 * trial columns) must be written, and the result of a lane must depend on that lane
 * only. */
typedef suture_status (*suture_force_fn)(const suture_context* context, const suture_batch* batch);

typedef struct suture_functor {
  uint32_t size;
  uint32_t dimension; /* of its cells, 0..3 */
  uint32_t cell_type; /* suture_cell_type, of that dimension */
  uint32_t shape;     /* suture_shape, dimension 3 */
  uint32_t faces;     /* suture_faces, dimension 2 */
  uint32_t lanes;     /* SUTURE_LANES */
  uint32_t scalar;    /* 0: double */
  uint32_t reads;     /* suture_read bits */
  uint32_t cell_column_count;
  uint32_t vertex_column_count;
  uint32_t alternative;           /* functors of a model with the same nonzero number are
                                     alternatives, the cheapest first: only the first of
                                     those that are enabled runs */
  uint32_t reserved;              /* 0 */
  const uint32_t* cell_columns;   /* indices of attributes of `dimension` */
  const uint32_t* vertex_columns; /* indices of attributes of dimension 0;
                                     UINT32_MAX means the kernel's mass */
  const char* name;               /* "edge springs" */
  const char* doc;
  suture_force_fn force;
  /* Extension of this functor by id, or NULL. [main], after loading. */
  const void* (*extension)(const char* id);
  /* Returns 0 if the functor would contribute only zeros with these parameters or,
   * for an alternative, if it is not written for them. NULL means always enabled.
   * [main], when the scene is compiled: a functor that returns 0 is skipped, and
   * inputs whose bits it clears in *reads (such as velocities without damping) are
   * not gathered but zero. A run that skips nothing (suture run --no-skip) gathers
   * all declared inputs, runs functors without alternatives whatever they return,
   * and runs the last enabled one of each group of alternatives. */
  int32_t (*enabled)(const suture_context* context, uint32_t* reads);
  /* 0: `force` computes forces. Otherwise 1 + the index of an attribute with SUTURE_FIELD:
   * `force` computes what flows into each node per second (unit of capacity x field / s), in
   * as many components of batch->force as the field has; the others are 0. Such a functor has
   * no trial columns, and offers suture.tangent/1, symmetric, where dx is a change of the field
   * and dv one of its rate (SUTURE_FIELD_RATE), laid out likewise. */
  uint32_t field;
  uint32_t reserved_2; /* 0 */
} suture_functor;

enum suture_model_flag {
  SUTURE_CONTINUUM = 1u << 0, /* an inverted element is an error by default */
  SUTURE_LINEAR = 1u << 1,    /* linear in displacements by design: for small rotations only,
                                 so its forces need not turn with the body */
  SUTURE_ACTIVE = 1u << 2     /* its energy or its forces at given positions change with time,
                                 such as those of a muscle: the body may have no rest state,
                                 and the host books the work of the forces instead of the
                                 energy. Hosts older than this flag refuse the model by name */
};

/* A physics model. Static const data; lives as long as the program. */
typedef struct suture_model {
  uint32_t size;
  uint32_t flags;       /* suture_model_flag */
  const char* id;       /* name in the scene: lower case, digits, '-' */
  const char* doc;      /* one line */
  const char* formula;  /* what is computed, in plain text */
  const char* citation; /* the source */
  uint32_t parameter_count;
  uint32_t attribute_count;
  uint32_t functor_count;
  uint32_t reserved; /* 0 */
  const suture_parameter* parameters;
  const suture_attribute* attributes;
  const suture_functor* functors;
  /* Checks what the ranges of single parameters cannot express (and reports it
   * through host->report), and stores what is derived from the parameters for the
   * functors: at most instance_bytes bytes at `instance`, which the host allocates
   * (aligned to SUTURE_ALIGNMENT), zeroes and frees. May be NULL. [main], once per
   * instance, before any functor. */
  suture_status (*prepare)(const suture_context* context, void* instance);
  uint64_t instance_bytes;
  /* Model-wide extension by id, or NULL. [main], after loading. */
  const void* (*extension)(const char* id);
} suture_model;

typedef struct suture_plugin {
  uint32_t size;
  uint32_t magic; /* SUTURE_MAGIC */
  uint32_t abi_major;
  uint32_t abi_minor;
  uint32_t lanes;
  uint32_t model_count;
  const char* id;
  const char* version;
  const char* license;
  const char* description;
  const suture_model* models;
  uint32_t required_extension_count;
  uint32_t reserved;                      /* 0 */
  const char* const* required_extensions; /* of the host */
} suture_plugin;

/* The only exported symbol. Has no side effect, may be called at any time and never
 * fails. */
typedef const suture_plugin* (*suture_plugin_fn)(void);
#define SUTURE_PLUGIN_SYMBOL "suture_plugin_v1"

/* -------------------------------------------------------------- extensions -- */
/* Extensions of functors, requested through suture_functor.extension. The batch is
 * that of the functor's force; batch->force is NULL. All [worker]. */

/* Stored energy of each cell, J. Forces without a potential (viscosity) are left
 * out. Of a functor that changes a field: the energy of field and deformation together, of which
 * its rates are the negative derivative by the field, and the forces of the model those by
 * positions. */
#define SUTURE_ENERGY_1 "suture.energy/1"
typedef struct suture_energy_1 {
  uint32_t size;
  uint32_t reserved;
  suture_status (*energy)(const suture_context* context, const suture_batch* batch,
                          double* out /* lanes */);
} suture_energy_1;

/* Of a functor that changes a field whose rates are no derivatives of an energy, such as the
 * pressure of a fluid: the power that each cell dissipates, W. Its suture.energy/1 is then what
 * the deformation stores; the field stores half its capacity times its square, and what flows
 * in supplies its value times the field. */
#define SUTURE_DISSIPATION_1 "suture.dissipation/1"
typedef struct suture_dissipation_1 {
  uint32_t size;
  uint32_t reserved;
  suture_status (*power)(const suture_context* context, const suture_batch* batch,
                         double* out /* lanes */);
} suture_dissipation_1;

/* Bounds for the stable step. For each node a symmetric 3x3 matrix in the order
 * XX YY ZZ XY YZ XZ: out[(node*6 + c)*lanes + lane]. Block-diagonal bounds of
 * the cell's stiffness K = -df/dx (N/m) and damping C = -df/dv (N s/m):
 *   x'Kx <= sum over nodes of x_n' stiffness_n x_n   for all x.
 * The host sums them per vertex and divides their largest eigenvalue by the mass. */
#define SUTURE_STABLE_DT_1 "suture.stable-dt/1"
typedef struct suture_stable_dt_1 {
  uint32_t size;
  uint32_t reserved;
  suture_status (*bounds)(const suture_context* context, const suture_batch* batch,
                          double* stiffness, double* damping);
} suture_stable_dt_1;

/* Output fields of the functor's cells, computed only when they are needed:
 * out[field][component*lanes + lane]; out[field] is NULL if it is not needed. */
#define SUTURE_OUTPUT_1 "suture.output/1"
typedef struct suture_field {
  uint32_t size;
  uint32_t components; /* 1, 3 or 6 (symmetric: XX YY ZZ XY YZ XZ) */
  const char* name;    /* "stress"; fields of the same name in two functors of a
                          model (parallelepipeds, general hexahedra) are one */
  const char* unit;
  const char* doc;
} suture_field;
typedef struct suture_output_1 {
  uint32_t size;
  uint32_t field_count;
  const suture_field* fields;
  suture_status (*compute)(const suture_context* context, const suture_batch* batch,
                           double* const* out);
} suture_output_1;

/* Directional derivative of the force: df = (df/dx) dx + (df/dv) dv, in arrays with
 * the layout of batch->force. For implicit and static solvers. */
#define SUTURE_TANGENT_1 "suture.tangent/1"
typedef struct suture_tangent_1 {
  uint32_t size;
  uint32_t reserved;
  suture_status (*apply)(const suture_context* context, const suture_batch* batch, const double* dx,
                         const double* dv, double* df);
} suture_tangent_1;

/* Inspects the cells once before the run and reports through host->report what the
 * user should know, such as rest shapes outside the model's range. The batch holds
 * rest positions (and positions equal to them) and columns. */
#define SUTURE_INSPECT_1 "suture.inspect/1"
typedef struct suture_inspect_1 {
  uint32_t size;
  uint32_t reserved;
  suture_status (*inspect)(const suture_context* context, const suture_batch* batch);
} suture_inspect_1;

#ifdef __cplusplus
}
#endif

#include "suture/layout.h"

#endif
