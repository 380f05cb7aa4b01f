#pragma once

#include <string>

namespace dlo::fuzz {

/// Reads a text as a scene file. A reader of a user's text must return a valid value or throw an
/// InputError of one line that begins with the file's name.
/// @throws std::logic_error if the reader breaks this; other exceptions of the reader pass
void scene(const std::string& text);
void model(const std::string& text);       ///< MJCF
void parameters(const std::string& text);  ///< parameters of the force model
void baseline(const std::string& text);    ///< a baseline; written and read again it is unchanged
void shape(const std::string& text);       ///< a shape of any format, in metres and in millimetres
void vary(const std::string& text);        ///< FIELD=VALUES and its scenes; no file's name

}  // namespace dlo::fuzz
