#pragma once
#include <string>

#include "harness/record.h"
#include "reports/table.h"

namespace raymeter {

TableColumn text_column(std::string title);

/// Of absent values: "-".
TableCell count_cell(const Record::Count& count);
TableCell number_cell(const Record::Number& number, double scale = 1);
TableCell megabytes_cell(const Record::Count& bytes);

/// Nanoseconds for a ray.
Record::Number time_per_ray(const Record& record);

}  // namespace raymeter
