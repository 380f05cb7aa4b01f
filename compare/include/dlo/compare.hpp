#pragma once

// Includes all that a program needs to judge shapes of rods: a scene made in code (make_scene) or
// read (load_scene), check(), calibrate(), solve(), compare(), and results as text or JSON
// (to_text, to_json). GoogleTest's matchers are in dlo/compare/gtest.hpp.

#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/result_text.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solve.hpp"
