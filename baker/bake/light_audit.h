// SPDX-License-Identifier: Apache-2.0
// Pass: names lights that look like mistakes.
#pragma once

#include "../error.h"
#include "../report.h"
#include "../scene.h"
#include "pack_schema.h"

namespace chandelier::baker {

/// One warning per kind of mistake, with the lights' names; counts per kind. After make_lights and batch_bvh.
void audit_lights(const Scene& scene, const pack::Contents& pack, PassReport& pass, Warnings& warnings);

}  // namespace chandelier::baker
