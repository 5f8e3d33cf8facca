// What most tests include, compiled once; see src/precompiled.h.
#pragma once

#include <gtest/gtest.h>

#include "precompiled.h"
