//! Finds what can be changed: numbers, operators and comparisons of kernels, as expressions that stand for others.

use std::{collections::BTreeMap, error::Error, ops::Range};

use syn::{
    BinOp, Expr, ExprBinary, ExprLit, ExprMethodCall, ExprRepeat, GenericArgument, ImplItemFn,
    Item, ItemFn, ItemMod, Lit, Macro, Type,
    spanned::Spanned,
    visit::{self, Visit},
};

use super::source::Source;

/// By how much numbers are made larger.
const LARGER: f64 = 1.1;

/// An expression, and what stands in its place.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// Index of the file.
    pub source: usize,
    /// Counted from 1.
    pub line: usize,
    /// Range of the expression in the file, in bytes.
    pub range: Range<usize>,
    /// Text that stands in its place.
    pub text: String,
    /// Such as `+ → -`, with `#2` behind it where that is the second in its line.
    pub change: String,
    /// True if a number is changed.
    pub is_number: bool,
}

/// All mutants of a file.
pub fn find(number: usize, source: &Source) -> Result<Vec<Mutant>, Box<dyn Error>> {
    let file =
        syn::parse_file(&source.text).map_err(|error| format!("{}: {error}", source.name))?;
    let mut finder = Finder {
        number,
        text: &source.text,
        found: Vec::new(),
    };
    finder.visit_file(&file);
    let mut found = finder.found;
    found.sort_by_key(|mutant| (mutant.line, mutant.range.start));
    Ok(found)
}

/// Tells those apart that change the same in one line.
pub fn number_within_lines(mutants: &mut [Mutant]) {
    let mut counts = BTreeMap::new();
    for mutant in mutants {
        let key = (mutant.source, mutant.line, mutant.change.clone());
        let count = counts.entry(key).or_insert(0);
        *count += 1;
        if *count > 1 {
            mutant.change += &format!(" #{count}");
        }
    }
}

struct Finder<'t> {
    number: usize,
    text: &'t str,
    found: Vec<Mutant>,
}

impl Finder<'_> {
    /// An expression in which one piece is replaced.
    fn replaced(&mut self, whole: Range<usize>, piece: impl Spanned, with: &str, is_number: bool) {
        let at = piece.span().byte_range();
        let was = &self.text[at.clone()];
        let text = [
            &self.text[whole.start..at.start],
            with,
            &self.text[at.end..whole.end],
        ]
        .concat();
        self.found.push(Mutant {
            source: self.number,
            line: piece.span().start().line,
            range: whole,
            text,
            change: format!("{was} → {with}"),
            is_number,
        });
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || matches!(&attribute.meta, syn::Meta::List(list) if list.path.is_ident("cfg") && list.tokens.to_string() == "test")
    })
}

/// Operator that an operator is changed to.
fn other_operator(operator: &BinOp) -> Option<&'static str> {
    Some(match operator {
        BinOp::Add(_) => "-",
        BinOp::Sub(_) => "+",
        BinOp::Mul(_) => "/",
        BinOp::Div(_) => "*",
        BinOp::AddAssign(_) => "-=",
        BinOp::SubAssign(_) => "+=",
        BinOp::MulAssign(_) => "/=",
        BinOp::DivAssign(_) => "*=",
        BinOp::Lt(_) => ">",
        BinOp::Gt(_) => "<",
        BinOp::Le(_) => ">=",
        BinOp::Ge(_) => "<=",
        _ => return None,
    })
}

/// Method that a comparison of vectors, or a bound, is changed to.
fn other_method(name: &str) -> Option<&'static str> {
    Some(match name {
        "simd_lt" => "simd_gt",
        "simd_gt" => "simd_lt",
        "simd_le" => "simd_ge",
        "simd_ge" => "simd_le",
        "max" => "min",
        "min" => "max",
        _ => return None,
    })
}

impl<'a> Visit<'a> for Finder<'_> {
    fn visit_item(&mut self, item: &'a Item) {
        // What the compiler computes cannot be decided at run time.
        if !matches!(item, Item::Const(_) | Item::Static(_)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, module: &'a ItemMod) {
        if !is_test(&module.attrs) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_fn(&mut self, function: &'a ItemFn) {
        if !is_test(&function.attrs) && function.sig.constness.is_none() {
            visit::visit_item_fn(self, function);
        }
    }

    fn visit_impl_item_fn(&mut self, function: &'a ImplItemFn) {
        if function.sig.constness.is_none() {
            visit::visit_impl_item_fn(self, function);
        }
    }

    fn visit_type(&mut self, _: &'a Type) {}

    fn visit_generic_argument(&mut self, _: &'a GenericArgument) {}

    fn visit_attribute(&mut self, _: &'a syn::Attribute) {}

    fn visit_pat(&mut self, _: &'a syn::Pat) {}

    fn visit_expr_repeat(&mut self, repeat: &'a ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    fn visit_expr_binary(&mut self, binary: &'a ExprBinary) {
        if let Some(other) = other_operator(&binary.op) {
            self.replaced(binary.span().byte_range(), binary.op, other, false);
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_method_call(&mut self, call: &'a ExprMethodCall) {
        if let Some(other) = other_method(&call.method.to_string()) {
            self.replaced(call.span().byte_range(), &call.method, other, false);
        }
        visit::visit_expr_method_call(self, call);
    }

    fn visit_expr_lit(&mut self, literal: &'a ExprLit) {
        if let Lit::Float(number) = &literal.lit
            && let Ok(value) = number.base10_parse::<f64>()
            && value != 0.0
        {
            let larger = format!("{:?}{}", (value * LARGER) as f32, number.suffix());
            self.replaced(literal.span().byte_range(), literal, &larger, true);
        }
    }

    /// The kernel in a macro that chooses an instruction set.
    fn visit_macro(&mut self, called: &'a Macro) {
        let name = called
            .path
            .segments
            .last()
            .map(|segment| segment.ident.to_string());
        if !name.is_some_and(|name| ["dispatch", "for_few"].contains(&name.as_str())) {
            return;
        }
        let tokens: Vec<_> = called.tokens.clone().into_iter().collect();
        let arrow = tokens
            .windows(2)
            .position(|two| two[0].to_string() == "=" && two[1].to_string() == ">");
        let Some(arrow) = arrow else { return };
        let kernel = tokens.into_iter().skip(arrow + 2).collect();
        if let Ok(kernel) = syn::parse2::<Expr>(kernel) {
            Visit::visit_expr(self, &kernel);
        }
    }
}
