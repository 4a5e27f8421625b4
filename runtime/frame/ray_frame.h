// SPDX-License-Identifier: Apache-2.0
// A frame with filter `rays`: the caller's rays stand between the device's work.
#pragma once

#include "frame/frame_recorder.h"

namespace chandelier {

/// Draws and waits. There is room for the plan already. Throws what RenderSettings::visibility throws, and gpu::Error.
void draw_by_rays(FrameRecorder& recorder, FrameSlot& slot, const RenderSettings& settings, const FramePlan& plan);

}  // namespace chandelier
