/* SPDX-License-Identifier: Apache-2.0
 *
 * Which lights will share a shadow map, what the maps take, and which lights lose theirs to a budget: the runtime's own
 * selection, for programs that have lights and no pack. Needs no Vulkan; plain C.
 *
 * Positions may be in any right-handed frame of metres, as long as the camera is in the same one. How many faces of a
 * cube a spot light needs depends on the axes: a frame turned by quarters, as Blender's is from glTF's, has the same.
 *
 * What needs geometry is not here: triangles and draws, walls between lights (--walls), and selection by error. The
 * shadows' bytes are those of depth; visibility textures (--deliver textures) are not counted.
 */
#ifndef CHANDELIER_PREVIEW_H
#define CHANDELIER_PREVIEW_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Changes whenever a struct or what a function does changes. */
#define CHANDELIER_PREVIEW_ABI 2u
#define CHANDELIER_PREVIEW_NONE 0xFFFFFFFFu
#define CHANDELIER_PREVIEW_MOST_LIGHTS 1048576u

enum ChandelierPreviewStatus {
  CHANDELIER_PREVIEW_OK = 0,
  CHANDELIER_PREVIEW_BAD_INPUT = 1, /* the error text says what and where */
  CHANDELIER_PREVIEW_FAILED = 2     /* out of memory */
};

enum ChandelierPreviewType {
  CHANDELIER_PREVIEW_POINT = 0,
  CHANDELIER_PREVIEW_SPOT = 1,
  CHANDELIER_PREVIEW_DIRECTIONAL = 2
};

/* Bits of a light's flags. */
enum { CHANDELIER_PREVIEW_DYNAMIC = 1, CHANDELIER_PREVIEW_OWN_MAP = 2, CHANDELIER_PREVIEW_NO_SHADOW = 4 };

/* One value for each light, the next one `stride_bytes` on; with stride 0 the first is every light's. No alignment is
 * asked for. Where `first` is null, every light has the default. */
typedef struct ChandelierPreviewColumn {
  const void* first;
  int64_t stride_bytes; /* 0, or at least the value's size */
} ChandelierPreviewColumn;

typedef struct ChandelierPreviewLights {
  uint32_t struct_bytes; /* sizeof this struct */
  uint32_t count;
  ChandelierPreviewColumn position;       /* float[3], metres; no default. Not looked at for directional lights */
  ChandelierPreviewColumn direction;      /* float[3], the way it shines; spot and directional lights need one */
  ChandelierPreviewColumn type;           /* uint8_t, ChandelierPreviewType; else all are points */
  ChandelierPreviewColumn intensity;      /* float, candela or lux; else 1. A light with 0 is none, as in a bake */
  ChandelierPreviewColumn color;          /* float[3], linear; else white. A black light is none */
  ChandelierPreviewColumn range_m;        /* float; else, and where it is 0, as the baker derives it */
  ChandelierPreviewColumn radius_m;       /* float; of a directional light the tangent of half its angle; else 0 */
  ChandelierPreviewColumn spot_outer_rad; /* float, half angle up to pi / 2; else 0.7854. Not looked at for others */
  ChandelierPreviewColumn flags;          /* uint8_t; else 0 */
  ChandelierPreviewColumn priority;       /* uint8_t; else 128 */
  ChandelierPreviewColumn group;          /* int32_t: lights with the same number share one map; below 0: of none */
} ChandelierPreviewLights;

typedef struct ChandelierPreviewSettings {
  uint32_t struct_bytes;
  uint32_t select;           /* 0: a map per light, 1: per light cluster */
  uint32_t filter;           /* 0: hard, 1: PCF, 2: PCSS */
  uint32_t distance_scaling; /* 0: grow, 1: paper-formula, 2: none */
  uint32_t dynamic_lights;   /* 0: cluster, 1: own */
  uint32_t face_size_px;
  float d_init_m;
  float z_far_m;
  float reference_share;    /* from so many clusters per light on, a map per light is drawn; above 1: never */
  float range_threshold_lx; /* of the bake: where a light ends that has no range */
  uint64_t max_shadow_maps; /* budgets; 0: none */
  uint64_t max_shadow_bytes;
} ChandelierPreviewSettings;

typedef struct ChandelierPreviewCamera {
  uint32_t struct_bytes;
  uint32_t sees_all; /* 1: only eye_ws counts, and every light is in view */
  float eye_ws[3];
  float forward_ws[3];
  float up_ws[3];
  float yfov_rad;
  float znear_m;
  uint32_t width_px; /* their ratio is the picture's */
  uint32_t height_px;
} ChandelierPreviewCamera;

typedef struct ChandelierPreviewCluster {
  uint32_t center; /* the light whose place the map is drawn from */
  uint32_t light_count;
  float d_min_m;
  float range_m;  /* C_att: beyond it no member reaches; 0 for directional lights */
  float spread_m; /* metric distance of the farthest member */
} ChandelierPreviewCluster;

typedef struct ChandelierPreviewBill {
  uint32_t lights; /* that give light */
  uint32_t lights_in_view;
  uint32_t shadowless_in_view; /* of them, those that throw no shadow */
  uint32_t shadow_maps;
  uint32_t shadow_views;
  uint32_t wanted_shadow_maps; /* with the d_init of the settings, whatever the budget */
  uint64_t shadow_bytes;
  uint64_t wanted_shadow_bytes;
  uint32_t lights_over_budget;
  float d_init_m;          /* as used: the settings' own where it keeps the budget, else the smallest that does */
  uint32_t reference_path; /* 1: clusters are nearly as many as lights: a map per light is drawn */
  uint32_t over_budget;    /* 1: the settings' d_init is */
  uint32_t misses_budget;  /* 1: no d_init keeps it; the largest tried is taken */
  uint32_t reserved;       /* 0 */
} ChandelierPreviewBill;

/* The arrays are the caller's, each for as many lights as there are, or null where it is of no interest. */
typedef struct ChandelierPreviewResult {
  uint32_t struct_bytes;
  uint32_t capacity;                  /* elements in each array */
  uint32_t* center_of_light;          /* the light whose map it takes; NONE out of view and without shadow */
  float* range_of_light_m;            /* as used; 0 for directional lights */
  uint8_t* over_budget_of_light;      /* 1: the budget takes the map that it would have to itself */
  ChandelierPreviewCluster* clusters; /* in ascending order of centre */
  uint32_t cluster_count;
  uint32_t reserved; /* 0 */
  ChandelierPreviewBill bill;
} ChandelierPreviewResult;

#if defined(__GNUC__)
#define CHANDELIER_PREVIEW_API __attribute__((visibility("default")))
#else
#define CHANDELIER_PREVIEW_API
#endif

CHANDELIER_PREVIEW_API uint32_t chandelier_preview_abi(void);

/* chandelier-play's and chandelier-bake's own defaults, with light clusters and PCSS. */
CHANDELIER_PREVIEW_API void chandelier_preview_defaults(ChandelierPreviewSettings* settings);

/* Selects. Where the settings' d_init breaks a budget, the smallest that keeps it is searched for, as chandelier-play
 * does with --max-shadow-maps and --max-shadow-bytes beside --d-init; where they keep it their d_init stays.
 * `error_text` gets one line without line feed, cut to `error_bytes` and always terminated; it may be null. Any thread
 * may call, any number at a time. */
CHANDELIER_PREVIEW_API int32_t chandelier_preview_select(const ChandelierPreviewLights* lights,
                                                         const ChandelierPreviewSettings* settings,
                                                         const ChandelierPreviewCamera* camera,
                                                         ChandelierPreviewResult* result, char* error_text,
                                                         size_t error_bytes);

#ifdef __cplusplus
}
#endif

#endif
