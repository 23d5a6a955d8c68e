#include "reports/table_cells.h"

#include "reports/record_text.h"

namespace raymeter {

TableColumn text_column(std::string title) {
  return {std::move(title), "", false};
}

TableCell count_cell(const Record::Count& count) {
  return {count ? grouped(*count) : "-"};
}

TableCell number_cell(const Record::Number& number, double scale) {
  return {three_digits(number ? *number * scale : number)};
}

TableCell megabytes_cell(const Record::Count& bytes) {
  return {three_digits(bytes ? Record::Number(static_cast<double>(*bytes) / 1e6) : Record::Number())};
}

Record::Number time_per_ray(const Record& record) {
  return record.mrays_per_s && *record.mrays_per_s > 0 ? Record::Number(1e3 / *record.mrays_per_s)
                                                       : Record::Number();
}

}  // namespace raymeter
