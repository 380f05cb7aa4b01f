#pragma once

#include <string>

namespace dlo::fuzz {

/// What every reader of a user's text promises: a value that the rest can work with, or an
/// InputError whose one line begins with the file's name. Anything else is thrown on, or is a
/// std::logic_error that says what was broken.
void scene(const std::string& text);
void model(const std::string& text);       ///< MJCF
void parameters(const std::string& text);  ///< of the force model
void baseline(const std::string& text);    ///< what is read is written, and read again the same
void shape(const std::string& text);       ///< of any kind, in metres and in millimetres
void vary(const std::string& text);        ///< FIELD=VALUES of a sweep, and the scenes it gives

}  // namespace dlo::fuzz
