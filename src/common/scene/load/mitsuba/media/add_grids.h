// The grids of media become the scene's.
#pragma once

#include "common/scene/load/mitsuba/xml/context.h"

namespace pt::mitsuba {

/// To be called when the scene has its shapes and its sensor. Outside of the box around its density
/// there is nothing of a medium: where shapes leave it room there, its grid gets a layer of zeros.
void add_grids(Context& context);

}  // namespace pt::mitsuba
