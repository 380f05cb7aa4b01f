#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// compare::shown() of each component, beside the vector's own norm.
[[nodiscard]] Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude);

/// What touches an obstacle, where and with what force, as a person reads it; obstacles count from
/// one.
[[nodiscard]] std::string contact_text(const energy_model::ContactPart& contact);

/// The same of all, by arc length; obstacles count from zero.
[[nodiscard]] Json contacts_json(const std::vector<energy_model::ContactPart>& contacts);

/// A shape as a person reads it.
[[nodiscard]] std::string solution_text(const compare::Solution& solution,
                                        const compare::Scene& scene);

[[nodiscard]] Json solution_json(const compare::Solution& solution, const compare::Scene& scene,
                                 const compare::Plan& plan);

/// The points, as `dlo check` reads them.
[[nodiscard]] std::string solution_csv(const compare::Solution& solution);

/// Returns one of several equilibria, with its forces and contacts.
/// @param number  in the order in which equilibria_text() lists them, from 1
/// @throws InputError if there are fewer
[[nodiscard]] compare::Solution numbered_equilibrium(const compare::AllSolutions& all, int number,
                                                     const compare::Scene& scene);

/// What tells several equilibria apart, and where they were looked for.
[[nodiscard]] std::string equilibria_text(const compare::AllSolutions& all,
                                          const compare::Scene& scene);

/// The first of several equilibria in full, then what tells them apart.
[[nodiscard]] Json equilibria_json(const compare::AllSolutions& all, const compare::Scene& scene,
                                   const compare::Plan& plan);

}  // namespace dlo::cli
